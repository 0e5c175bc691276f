// Raw pictures of a captured session to linear views and masks, from the session folder alone.
#pragma once

#include <filesystem>
#include <string>

#include "station/documents/views_file.h"
#include "station/progress.h"

namespace station {

// Writes linear/<view>.exr, masks/<view>.png (the threads of a first rendering, its edge eroded by two standard errors of the
// calibration), masks/<view>-overlay.png (its outline on the photograph), linear/views.json and both folders' manifests; running it again gives the
// same files. The holder's pose at each mounting comes from its tags in that mounting's pose picture.
// Views are developed at the same time, as many as processors and 3 GiB of memory allow; their pictures are not returned.
// Errors: std::runtime_error when the session lacks a picture, or too few tags are seen.
DevelopedViews develop_session(const std::filesystem::path& session, ProgressStyle progress_style);

// A line per view for people.
std::string describe(const DevelopedViews& developed);

}  // namespace station
