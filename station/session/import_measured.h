// A session from views that another lab measured: linear pictures and a table of directions (measured_file.h). The
// pictures are kept as they came, in raw/, and their masks in calibration/; the rest is as after develop.
#pragma once

#include <filesystem>

#include "station/output/progress.h"

namespace station {

// `list`: the measurement file. Makes the session's folder, which must be new, empty or that of the same import, which
// then goes on, and develops it. Errors: std::runtime_error, one line, those of read_measured_file and
// develop_measured; also for pictures or masks that cannot be read or differ in size, and another session.
void import_measured(const std::filesystem::path& list, const std::filesystem::path& session,
                     ProgressStyle progress_style);

}  // namespace station
