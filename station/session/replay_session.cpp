#include "station/session/replay_session.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "station/bench/calibration_validity.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/reader.h"
#include "station/session/capture/recorder.h"
#include "station/session/replay/played_devices.h"
#include "station/session/run_session.h"

namespace station {
namespace fs = std::filesystem;
namespace {

// A clock that tells the times of the journal's records one after the other, then the last one for ever.
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
  for (const fs::directory_entry& entry : fs::directory_iterator(session / "calibration"))
    files[entry.path().filename().string()] = bytes_of_file(entry.path());
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
RunState run_once(SessionFolder& session, StandIns& played, rig::Clock& clock, const CaptureRequest& request) {
  const SessionFile asked = read_session_file(session.path());
  const RigCalibration calibration = read_calibration(session.path() / "calibration");
  ProgressDisplay display("replay", request.progress_style);
  RunOptions options;
  options.stop_wish = played.wish;
  options.progress = [&](const Progress& p) {
    display.show(static_cast<int>(p.done), static_cast<int>(p.total), p.step);
  };
  try {
    run_session(session, {*played.camera, *played.turntable, *played.person, clock}, asked, calibration, request,
                options);
  } catch (const RecordingFailed&) {
    throw;
  } catch (const RecordingEnds&) {
  } catch (const std::exception&) {
  }
  return state_of(session.records(), false);
}

}  // namespace

ReplayReport replay_session(const fs::path& recorded, CaptureRequest request, bool resume) {
  const std::vector<RecordedRun> runs = read_device_log(recorded);
  const std::vector<JournalRecord> records = read_journal(recorded / "journal.jsonl").records;
  if (records.empty())
    throw std::runtime_error("'" + recorded.string() + "' has an empty journal; there is nothing to replay");
  const auto pictures = recorded_pictures(recorded);
  RecordedClock clock(records);
  FileSystem disk;
  request.record = true;
  ReplayReport report;
  report.recorded_s = 86400 * days_between(records.front().utc, records.back().utc);
  if (resume) {
    SessionFolder session = SessionFolder::open(request.session, clock, disk);
    StandIns played = play_freely(runs, pictures);
    report.state = run_once(session, played, clock, request);
    report.runs = 1;
    return report;
  }
  const nlohmann::json document = read_json_file(recorded / "session.json");
  for (const RecordedRun& run : runs) {
    SessionFolder session =
        report.runs == 0 ? SessionFolder::create(request.session, document, calibration_files(recorded), clock, disk)
                         : SessionFolder::open(request.session, clock, disk);
    StandIns played = play_strictly(run, pictures);
    request.reshoot = run.reshoot;
    report.state = run_once(session, played, clock, request);
    ++report.runs;
  }
  const auto files = hashes(recorded);
  report.files = files.size();
  report.differences = differences(files, hashes(request.session));
  return report;
}

}  // namespace station
