// Devices that answer what the devices of a recorded session answered.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "station/session/replay/device_log.h"

namespace station {

// Files of a recorded session's pictures by their SHA-256: raw/, refused/ and replay/.
std::map<std::string, std::filesystem::path> recorded_pictures(const std::filesystem::path& session);

// Thrown where a recorded process was killed. It is no std::exception, so that nothing is written about it.
struct RecordingEnds {};

// Stand-ins that answer the calls of one run in the recorded order, errors included. A call other than the recorded one
// is an error that names both.
StandIns play_strictly(const RecordedRun& run, const std::map<std::string, std::filesystem::path>& pictures);

// Stand-ins that answer whatever is asked, in any order: a picture is one that was recorded under the same lamp,
// mounting, angle and exposure. The errors of the recording are left out.
StandIns play_freely(const std::vector<RecordedRun>& runs,
                     const std::map<std::string, std::filesystem::path>& pictures);

}  // namespace station
