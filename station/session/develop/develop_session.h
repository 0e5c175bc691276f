// The development of a captured session: raw pictures to linear views and masks, from the session folder alone.
#pragma once

#include <filesystem>
#include <string>

#include "station/documents/views_file.h"
#include "station/output/progress.h"

namespace station {

// Develops a session. Written are linear/<view>.exr, masks/<view>.png (the threads as a first rendering shows them,
// their edge eroded by two standard errors of the calibration), masks/<view>-overlay.png (the mask's outline on the
// photograph), linear/views.json and both folders' manifests; running it again gives the same files. The holder's pose
// at each mounting comes from its tags in that mounting's pose pictures. As many views are developed at a time as
// processors and 3 GiB of memory allow; the returned views have no pictures. Errors: std::runtime_error when the
// session lacks a picture, or too few tags are seen.
DevelopedViews develop_session(const std::filesystem::path& session, ProgressStyle progress_style);

// The result in one line per view for people.
std::string describe(const DevelopedViews& developed);

}  // namespace station
