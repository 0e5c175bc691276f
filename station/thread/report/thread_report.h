// The fit's part of a session report: parameters, lobe energies, the thread and the baselines that were fitted side by
// side on the same views with their residuals and errors [Xia 2025, figures 6 and 7], and the woven cloth.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "station/documents/views_file.h"

namespace station {

// The section on the thread as HTML; empty for a session without result/thread.json.
std::string thread_section(const std::filesystem::path& session, const DevelopedViews& developed);
// The section with the pictures of result/cloth as HTML; empty when there are none.
std::string cloth_section(const std::filesystem::path& session, const DevelopedViews& developed);

// Of each view the photograph and below it its twins by the fitted models, in the order of fitted_model_names and at
// one exposure, as in figures 6 and 7; six views to a row. Empty without a thread.
std::vector<std::string> fitted_model_names(const std::filesystem::path& session);
cv::Mat3b models_picture(const std::filesystem::path& session, const DevelopedViews& developed);

// The picture of the README: two photographs beside their fitted twins, and the cloth; empty without a thread and a
// cloth.
cv::Mat3b overview_picture(const std::filesystem::path& session, const DevelopedViews& developed);

}  // namespace station
