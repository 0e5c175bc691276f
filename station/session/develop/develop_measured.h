// The views of a session that another lab measured: linear already, so that only their masks may have to be made.
#pragma once

#include <filesystem>

#include "station/documents/session_file.h"
#include "station/documents/views_file.h"
#include "station/output/progress.h"

namespace station {

// Writes picture, mask and its outline of each of the session's measured views, as develop_session does, and returns
// them without their pictures. Errors: std::runtime_error for a picture that cannot be read, or in whose place there is
// no thread.
DevelopedViews develop_measured(const std::filesystem::path& session, const SessionFile& asked,
                                ProgressStyle progress_style);

}  // namespace station
