#include "tests/station/session/capture/fakes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "station/documents/plan_file.h"

namespace station {
namespace fs = std::filesystem;

namespace {

// In memory where the system offers that and nobody said otherwise: these tests make thousands of small files.
fs::path place_for_temporary_folders() {
  const bool memory = std::getenv("TMPDIR") == nullptr && ::access("/dev/shm", W_OK) == 0;
  return memory ? fs::path("/dev/shm") : fs::temp_directory_path();
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (place_for_temporary_folders() / "capture-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path TemporaryFolder::session(int number) const {
  std::string name = "session-";
  name += std::to_string(number);
  return path_ / name;
}

bool FakeFileSystem::in_trouble() {
  ++calls;
  return (trouble == Trouble::fail_from_then_on && calls >= at_call) || (trouble != Trouble::none && calls == at_call);
}

void FakeFileSystem::suffer() const {
  if (trouble == Trouble::kill) ::raise(SIGKILL);
  throw std::system_error(error, std::generic_category());
}

OpenFile FakeFileSystem::open(const fs::path& path, int flags) {
  if (in_trouble()) suffer();
  OpenFile file = FileSystem::open(path, flags);
  unsynced_.erase(file.descriptor());  // of a file that is closed
  return file;
}

void FakeFileSystem::write(const OpenFile& file, std::span<const std::byte> bytes) {
  const bool trouble_now = in_trouble();
  const auto written = trouble_now ? bytes.first(bytes.size() / 2) : bytes;
  if (volatile_cache) {
    auto& waiting = unsynced_[file.descriptor()];
    waiting.insert(waiting.end(), written.begin(), written.end());
  } else {
    FileSystem::write(file, written);
  }
  if (trouble_now) suffer();
}

void FakeFileSystem::sync(const OpenFile& file) {
  if (in_trouble()) suffer();
  FileSystem::write(file, unsynced_[file.descriptor()]);
  unsynced_.erase(file.descriptor());
  struct stat status {};
  if (::fstat(file.descriptor(), &status) == 0 && S_ISDIR(status.st_mode)) {
    for (const auto& [from, to] : unsynced_names_) FileSystem::rename(from, to);
    unsynced_names_.clear();
  }
}

void FakeFileSystem::rename(const fs::path& from, const fs::path& to) {
  if (in_trouble()) suffer();
  if (volatile_cache)
    unsynced_names_.emplace_back(from, to);
  else
    FileSystem::rename(from, to);
}

std::vector<double> FakeCamera::shutter_times_s() {
  std::vector<double> times;
  for (int third = -30; third <= 15; ++third) times.push_back(std::exp2(third / 3.0));
  return times;
}

rig::CameraSettings FakeCamera::configure(const rig::CameraSettings& wanted) {
  if (!stuck_shutter) now = wanted;
  return now;
}

rig::Picture FakeCamera::capture() {
  if (++captures == fail_at_capture)
    throw std::runtime_error("the camera was asked for a picture and did not answer; switch it off and on");
  if (((late_at > 0 && captures >= late_at) || stale) && !last_.bytes.empty()) return last_;
  const double level = std::min(1.0, radiance() * now.exposure_s);
  static int pictures = 0;  // of all cameras of this process
  const std::array<double, 3> content = {level, static_cast<double>(::getpid()), static_cast<double>(++pictures)};
  last_ = {
      .bytes = std::vector<std::byte>(400), .extension = "arw", .settings = now, .utc = "2027-01-15T08:00:00.000Z"};
  if (lies) last_.settings.exposure_s *= 2;
  std::memcpy(last_.bytes.data(), content.data(), sizeof content);
  if (empty) last_.bytes.clear();
  return last_;
}

double FakeCamera::level(const rig::Picture& picture) {
  double level = 0;
  std::memcpy(&level, picture.bytes.data(), sizeof level);
  return level;
}

void FakeTurntable::move_to(double angle_rad) {
  if (!homed) throw std::runtime_error("the platform was asked to turn before it was homed");
  ++moves;
  if (on_move) on_move(angle_rad);
  angle_rad_ = angle_rad + (slips ? 0.05 : 0.0);
}

FakeStation::FakeStation() {
  options.settings.exposure_s = 0.25;
  // Behind the holder it is eight times as bright as in front of it, so that exposures differ.
  camera.radiance = [this] { return !person.asked.empty() && person.asked.back().lamp == rig::Lamp::back ? 8.0 : 1.0; };
  options.choose_exposure = [](const PlanStep&, const rig::Picture& test) {
    const double level = FakeCamera::level(test);
    return level >= 1 ? ExposureChoice{.exposure_s = test.settings.exposure_s / 4, .done = false}
                      : ExposureChoice{.exposure_s = test.settings.exposure_s * 0.6 / level,
                                       .done = std::abs(std::log2(level / 0.6)) < 1.0 / 3};
  };
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

Plan small_plan() {
  const Plan whole = make_capture_plan({});
  Plan plan;
  for (const char* id : {"pose-horizontal-1", "reflection-horizontal-1", "reflection-horizontal-2", "transmission-1",
                         "dark-reflection-horizontal-1", "dark-reflection-horizontal-2", "dark-transmission-1"}) {
    plan.steps.push_back(*find_step(whole, id));
    plan.steps.back().verify.clear();  // fakes show nothing
  }
  return plan;
}

nlohmann::json session_document(const Plan& plan) {
  return {{"format", "threadstation/session"}, {"version", 1}, {"operator", "test"}, {"plan", plan_to_json(plan)}};
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
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

std::string message_of(const std::function<void()>& action) {
  try {
    action();
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace station
