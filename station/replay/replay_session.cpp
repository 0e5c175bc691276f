#include "station/replay/replay_session.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>

#include "station/calibration_validity.h"
#include "station/capture/recorder.h"
#include "station/capture/sha256.h"
#include "station/documents/reader.h"
#include "station/replay/played_devices.h"
#include "station/run_session.h"

namespace station {
namespace fs = std::filesystem;
namespace {

// Tells the times of the journal's records one after the other, then the last one for ever.
class RecordedClock final : public rig::Clock {
 public:
  explicit RecordedClock(const std::vector<JournalRecord>& records) {
    for (const JournalRecord& record : records) utc_.push_back(record.utc);
  }
  double monotonic_s() override { return 0; }
  std::string utc() override { return utc_.at(std::min(next_++, utc_.size() - 1)); }
  void sleep_s(double) override {}

 private:
  std::vector<std::string> utc_;
  std::size_t next_ = 0;
};

CalibrationFiles calibration_files(const fs::path& session) {
  CalibrationFiles files;
  for (const fs::directory_entry& entry : fs::directory_iterator(session / "calibration")) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    files[entry.path().filename().string()] = {bytes, bytes + text.size()};
  }
  return files;
}

std::map<std::string, std::string> hashes(const fs::path& session) {
  std::map<std::string, std::string> result;
  for (const char* name : {"session.json", "journal.jsonl"})
    if (fs::exists(session / name)) result[name] = sha256_of_file(session / name);
  for (const char* folder : {"raw", "refused", "calibration", kReplayFolder}) {
    if (!fs::is_directory(session / folder)) continue;
    for (const fs::directory_entry& entry : fs::directory_iterator(session / folder))
      result[std::string(folder) + "/" + entry.path().filename().string()] = sha256_of_file(entry.path());
  }
  return result;
}

std::vector<std::string> differences(const std::map<std::string, std::string>& recorded,
                                     const std::map<std::string, std::string>& replayed) {
  std::vector<std::string> lines;
  for (const auto& [name, hash] : recorded)
    if (!replayed.contains(name))
      lines.push_back(name + " was not made again");
    else if (replayed.at(name) != hash)
      lines.push_back(name + " differs from the recording");
  for (const auto& [name, hash] : replayed)
    if (!recorded.contains(name)) lines.push_back(name + " is not in the recording");
  return lines;
}

// A device's error ends a run as it ended the recorded one; the journal's comparison tells whether it was the same.
RunState run_once(SessionFolder& session, PlayedDevices& played, rig::Clock& clock, const ReplayRequest& request,
                  const std::vector<std::string>& reshoot) {
  const SessionFile asked = read_session_file(session.path());
  const RigCalibration calibration = read_calibration(session.path() / "calibration");
  ProgressDisplay display("replay", request.progress_style);
  SessionRun run{.reshoot = reshoot, .record = true, .stop_wish = played.wish, .progress = {}, .judged = {}};
  run.progress = [&](const Progress& p) {
    display.show(static_cast<int>(p.done), static_cast<int>(p.total), p.step);
  };
  try {
    run_session(session, {*played.camera, *played.turntable, *played.person, clock}, asked, calibration, run);
  } catch (const RecordingFailed&) {
    throw;
  } catch (const RecordingEnds&) {
  } catch (const std::exception&) {
  }
  return state_of(session.records(), false);
}

}  // namespace

ReplayReport replay_session(const ReplayRequest& request) {
  const std::vector<RecordedRun> runs = read_device_log(request.session);
  const std::vector<JournalRecord> records = read_journal(request.session / "journal.jsonl").records;
  if (records.empty())
    throw std::runtime_error("'" + request.session.string() + "' has an empty journal; there is nothing to replay");
  const auto pictures = recorded_pictures(request.session);
  RecordedClock clock(records);
  FileSystem disk;
  ReplayReport report;
  report.recorded_s = 86400 * days_between(records.front().utc, records.back().utc);
  if (request.resume) {
    SessionFolder session = SessionFolder::open(request.out, clock, disk);
    PlayedDevices played = play_freely(runs, pictures);
    report.state = run_once(session, played, clock, request, {});
    report.runs = 1;
    return report;
  }
  const nlohmann::json document = read_json_file(request.session / "session.json");
  for (const RecordedRun& run : runs) {
    SessionFolder session = report.runs == 0 ? SessionFolder::create(request.out, document,
                                                                     calibration_files(request.session), clock, disk)
                                             : SessionFolder::open(request.out, clock, disk);
    PlayedDevices played = play_strictly(run, pictures);
    report.state = run_once(session, played, clock, request, run.reshoot);
    ++report.runs;
  }
  const auto recorded = hashes(request.session);
  report.files = recorded.size();
  report.differences = differences(recorded, hashes(request.out));
  return report;
}

}  // namespace station
