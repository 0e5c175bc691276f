#include "tests/station/session/capture/fakes.h"

#include <algorithm>

#include "station/documents/plan_file.h"
#include "tests/station/bench/fake_exposure.h"

namespace station {
namespace fs = std::filesystem;

FakeStation::FakeStation() {
  options.settings.exposure_s = 0.25;
  // Behind the holder it is eight times as bright as in front of it, so that exposures differ.
  camera.radiance = [this] { return !person.asked.empty() && person.asked.back().lamp == rig::Lamp::back ? 8.0 : 1.0; };
  options.choose_exposure = choose_fake_exposure;
  options.nominal_holder_pose = [](rig::Mounting mounting) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().z() = mounting == rig::Mounting::horizontal ? 60 : 80;
    return pose;
  };
}

SessionFolder FakeStation::create(const fs::path& folder, const Plan& plan) {
  const CalibrationFiles calibration = {{"calibration.json", {std::byte{'{'}, std::byte{'}'}}}};
  return SessionFolder::create(folder, session_document(plan), calibration, clock, disk);
}

SessionFolder FakeStation::open(const fs::path& folder) {
  return SessionFolder::open(folder, clock, disk);
}

RunState FakeStation::run(const fs::path& folder, const Plan& plan) {
  SessionFolder session = is_session(folder) ? open(folder) : create(folder, plan);
  return run_plan(plan, devices(), session, options);
}

nlohmann::json session_document(const Plan& plan) {
  return {{"format", "threadstation/session"}, {"version", 1}, {"operator", "test"}, {"plan", plan_to_json(plan)}};
}

std::vector<JournalRecord> records_of(const fs::path& session) {
  return read_journal(session / "journal.jsonl").records;
}

std::map<std::string, PictureRecord> pictures_of(const fs::path& session) {
  return taken_pictures(records_of(session));
}

std::size_t count_events(const fs::path& session, const std::string& event) {
  const std::vector<JournalRecord> records = records_of(session);
  return static_cast<std::size_t>(std::count_if(records.begin(), records.end(),
                                                [&](const JournalRecord& record) { return record.event == event; }));
}

}  // namespace station
