// Everything that the devices of a session said, in its order, so that the session can be played again without them
// (played_devices.h).
//
//   replay/devices.jsonl    a line for each run: {"run": {"reshoot": [steps]}}, and for each call of a device:
//     {"call": "identity" | "shutter_times_s" | "configure" | "capture" | "home" | "move_to" | "angle_rad" |
//      "arrange" | "stop_wish", what was asked, "answer": what came back, or "error": the line that was thrown}
//   replay/<first 16 digits of its sha256>.<extension>   each test picture; all others are in raw/ and refused/
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rig/devices/camera.h"
#include "rig/devices/turntable.h"
#include "rig/people/operator.h"
#include "station/documents/disk/file_system.h"
#include "station/session/capture/runner.h"

namespace station {

inline constexpr const char* kReplayFolder = "replay";

// Written while a session is recorded. Errors: std::runtime_error of the disk.
class DeviceLog {
 public:
  // Makes the folder in the session. The file system must outlive the log.
  DeviceLog(const std::filesystem::path& session, const std::vector<std::string>& reshoot, FileSystem& file_system);

  void add(const nlohmann::json& line);
  void keep_test(const rig::Picture& test);

 private:
  std::filesystem::path folder_;
  FileSystem* file_system_;
  OpenFile file_;
};

struct RecordedRun {
  std::vector<std::string> reshoot;  // as CaptureRequest's
  std::vector<nlohmann::json> calls;
};

bool is_recorded(const std::filesystem::path& session);

// A last line that a killed process left torn is left out. Errors: std::runtime_error that names file and line, or says
// that the session was captured without --record.
std::vector<RecordedRun> read_device_log(const std::filesystem::path& session);

// Devices that a run is given in place of the rig's own, and what asks it to stop.
struct StandIns {
  std::unique_ptr<rig::Camera> camera;
  std::unique_ptr<rig::Turntable> turntable;
  std::unique_ptr<rig::Operator> person;
  std::function<StopWish()> wish;
};

// Stand-ins that pass every call on to `devices` and `wish`, and write it and its answer to `log`; all three must
// outlive them.
StandIns record_devices(const RunDevices& devices, const std::function<StopWish()>& wish, DeviceLog& log);

}  // namespace station
