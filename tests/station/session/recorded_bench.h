// The bench of the recorded session in fixtures: its rig, spool and calibration with in-process devices, for runs of a
// few views in which something goes wrong.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "station/documents/calibration_file.h"
#include "station/documents/session_file.h"
#include "station/session/record/verify.h"
#include "station/session/run_session.h"
#include "tests/station/session/capture/fakes.h"

namespace station {

std::filesystem::path recorded_session();

struct RecordedBench {
  RecordedBench();
  RecordedBench(const RecordedBench&) = delete;
  RecordedBench& operator=(const RecordedBench&) = delete;

  // Starts the session, or goes on with it; returns what it threw, or nothing.
  std::string run(const RunOptions& options = {}, const CaptureRequest& request = {});
  std::vector<JournalRecord> records() const { return records_of(path); }
  std::string outcome() const;
  // The reasons of the refused pictures.
  std::vector<std::string> refused() const;

  TemporaryFolder folder;
  std::filesystem::path path = folder / "session";
  SessionFile asked;  // its plan is two poses, three reflections and a transmission
  RigCalibration calibration;
  std::unique_ptr<rig::Clock> clock = std::make_unique<rig::SimulatedClock>(1.8e9);
  std::unique_ptr<rig::SimulatedBench> bench;
  std::unique_ptr<rig::Camera> camera;
  std::unique_ptr<rig::Turntable> turntable;
  std::unique_ptr<rig::Operator> person;
  // Hooks between the runner and the devices; each calls the device and may do something else as well.
  std::function<rig::Picture(rig::Camera&)> on_capture = [](rig::Camera& device) { return device.capture(); };
  std::function<void(rig::Turntable&, double)> on_move = [](rig::Turntable& device, double angle_rad) {
    device.move_to(angle_rad);
  };
  std::function<double(rig::Turntable&)> on_read = [](rig::Turntable& device) { return device.angle_rad(); };
  std::function<void(rig::Operator&, rig::Arrangement)> on_arrange =
      [](rig::Operator& device, const rig::Arrangement& wanted) { device.arrange(wanted); };
  FileSystem disk;
};

}  // namespace station
