// What test doubles of a whole capture run share: devices that answer at once, a disk that fails, a small plan.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "rig/devices/clock.h"
#include "station/session/capture/runner.h"
#include "station/session/record/picture_record.h"
#include "station/session/record/session_folder.h"
#include "tests/station/documents/small_plan.h"
#include "tests/support/fake_devices.h"
#include "tests/support/fake_file_system.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace station {

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

nlohmann::json session_document(const Plan& plan);

std::vector<JournalRecord> records_of(const std::filesystem::path& session);
std::map<std::string, PictureRecord> pictures_of(const std::filesystem::path& session);
std::size_t count_events(const std::filesystem::path& session, const std::string& event);

}  // namespace station
