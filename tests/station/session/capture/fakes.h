// Test doubles for capture sessions: devices that answer at once, and a disk that fails or ends the process at a chosen
// call. They are fakes, not the simulated bench: they do what a test tells them.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "rig/devices/camera.h"
#include "rig/devices/clock.h"
#include "rig/devices/turntable.h"
#include "rig/people/operator.h"
#include "station/session/capture/runner.h"
#include "station/session/record/picture_record.h"
#include "station/session/record/session_folder.h"

namespace station {

// A new folder, removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::filesystem::path session(int number) const;

 private:
  std::filesystem::path path_;
};

// A file system that does not wait for the disk: a killed process loses nothing that it has written.
class FakeFileSystem final : public FileSystem {
 public:
  enum class Trouble { none, fail_once, fail_from_then_on, kill };

  Trouble trouble = Trouble::none;
  int at_call = 0;              // number of the call with trouble, from 1
  int error = 0;                // errno of a failure
  bool volatile_cache = false;  // kill loses what was not synced, as a power cut does
  int calls = 0;

  OpenFile open(const std::filesystem::path& path, int flags) override;
  void write(const OpenFile& file, std::span<const std::byte> bytes) override;  // writes half, then has trouble
  void sync(const OpenFile& file) override;
  void rename(const std::filesystem::path& from, const std::filesystem::path& to) override;

 private:
  bool in_trouble();
  void suffer() const;  // throws, or does not return

  std::map<int, std::vector<std::byte>> unsynced_;  // by descriptor
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> unsynced_names_;
};

class FakeCamera final : public rig::Camera {
 public:
  std::string serial = "123";
  rig::CameraSettings now;
  std::function<double()> radiance = [] { return 1.0; };  // picture level = radiance x exposure, at most 1
  int captures = 0;
  int fail_at_capture = 0;     // number of the capture that fails, from 1
  bool stuck_shutter = false;  // keeps its old exposure time and says so
  bool stale = false;          // delivers its last picture again and again
  int late_at = 0;             // from this capture on it delivers the picture before
  bool empty = false;
  bool lies = false;  // the picture was taken with another exposure than was read back

  rig::CameraIdentity identity() override { return {"Maker", "Model", serial, 600, 400}; }
  std::vector<double> shutter_times_s() override;
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override;
  rig::Picture capture() override;  // no two pictures are alike, also among processes
  std::vector<std::byte> preview() override { return {}; }

  static double level(const rig::Picture& picture);

 private:
  rig::Picture last_;
};

class FakeTurntable final : public rig::Turntable {
 public:
  bool homed = false, slips = false;
  double off_rad = 0;  // by how much the platform stands further than is read
  int stops = 0, moves = 0;
  std::function<void()> on_stop;
  std::function<void(double angle_rad)> on_move;  // called before the platform arrives; may throw

  void home() override { homed = true, angle_rad_ = 0; }
  void move_to(double angle_rad) override;
  void stop() override {
    ++stops;
    if (on_stop) on_stop();
  }
  double angle_rad() override { return angle_rad_; }
  rig::TurntableState state() override { return rig::TurntableState::idle; }
  void stands_at(double angle_rad) override {
    off_rad -= angle_rad - angle_rad_;
    angle_rad_ = angle_rad;
  }

 private:
  double angle_rad_ = 0;
};

class FakePerson final : public rig::Operator {
 public:
  std::vector<rig::Arrangement> asked;
  void arrange(const rig::Arrangement& wanted) override { asked.push_back(wanted); }
};

// Devices, clock, disk and options of one run, put together.
struct FakeStation {
  FakeStation();
  FakeStation(const FakeStation&) = delete;
  FakeStation& operator=(const FakeStation&) = delete;

  RunDevices devices() { return {camera, turntable, person, clock}; }
  SessionFolder create(const std::filesystem::path& folder, const Plan& plan);
  SessionFolder open(const std::filesystem::path& folder);
  // Starts a session, or resumes the one that is there.
  RunState run(const std::filesystem::path& folder, const Plan& plan);

  FakeCamera camera;
  FakeTurntable turntable;
  FakePerson person;
  rig::SimulatedClock clock{1.8e9};
  FakeFileSystem disk;
  RunOptions options;
};

// A plan that runs quickly: a pose, three views of which two get the same exposure, and a dark for each.
Plan small_plan();

nlohmann::json session_document(const Plan& plan);

std::string text_of(const std::filesystem::path& file);
void write_text(const std::filesystem::path& file, const std::string& text);
std::vector<JournalRecord> records_of(const std::filesystem::path& session);
std::map<std::string, PictureRecord> pictures_of(const std::filesystem::path& session);
std::size_t count_events(const std::filesystem::path& session, const std::string& event);

// The message that `action` throws; "" when it throws nothing.
std::string message_of(const std::function<void()>& action);

}  // namespace station
