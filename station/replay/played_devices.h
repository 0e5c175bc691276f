// Devices that answer what the devices of a recorded session answered.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "station/replay/device_log.h"

namespace station {

// Files of a recorded session's pictures by their SHA-256: raw/, refused/ and replay/.
std::map<std::string, std::filesystem::path> recorded_pictures(const std::filesystem::path& session);

struct PlayedDevices {
  std::unique_ptr<rig::Camera> camera;
  std::unique_ptr<rig::Turntable> turntable;
  std::unique_ptr<rig::Operator> person;
  std::function<StopWish()> wish;
};

// Thrown where a recorded process was killed; no std::exception, so that nothing is written about it.
struct RecordingEnds {};

// In the recorded order, errors included: another call than the recorded one is an error that names both.
PlayedDevices play_strictly(const RecordedRun& run, const std::map<std::string, std::filesystem::path>& pictures);

// Whatever is asked, in any order: a picture is one that was recorded under the same lamp, mounting, angle and exposure;
// the errors of the recording are left out.
PlayedDevices play_freely(const std::vector<RecordedRun>& runs,
                          const std::map<std::string, std::filesystem::path>& pictures);

}  // namespace station
