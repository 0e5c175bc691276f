// The part of a session's report about what was fitted and woven: parameters, lobe energies, photographs beside their
// fitted twins and residuals, cloth.
#pragma once

#include <filesystem>
#include <string>

#include "station/documents/views_file.h"

namespace station {

// HTML; empty for a session without result/thread.json.
std::string thread_section(const std::filesystem::path& session, const DevelopedViews& developed);
// The pictures of result/cloth, HTML; empty when there are none.
std::string cloth_section(const std::filesystem::path& session, const DevelopedViews& developed);

// For README: two photographs beside their fitted twins, and the cloth, in one picture; empty without a thread and cloth.
cv::Mat3b overview_picture(const std::filesystem::path& session, const DevelopedViews& developed);

}  // namespace station
