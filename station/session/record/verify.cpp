#include "station/session/record/verify.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/manifest.h"
#include "station/documents/plan_file.h"
#include "station/documents/reader.h"
#include "station/session/record/bracket.h"
#include "station/session/record/picture_record.h"
#include "station/session/record/session_folder.h"

namespace station {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

// Splits a name into its beginning and its number: "dark-transmission-" and 3; 0 when there is no number.
std::pair<std::string, unsigned long> numbered(const std::string& name) {
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  const bool has_number = digits < name.size() && name.size() - digits < 9;
  return {name.substr(0, digits), has_number ? std::stoul(name.substr(digits)) : 0};
}

// The names as one text in which following numbers are joined: "pose-1, view-1 to 4".
std::string enumerated(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t begin = 0, end = 0; begin < names.size(); begin = end) {
    const auto [stem, first] = numbered(names[begin]);
    for (end = begin + 1; first > 0 && end < names.size(); ++end)
      if (numbered(names[end]) != std::pair(stem, first + (end - begin))) break;
    end = std::max(end, begin + 1);
    text += (text.empty() ? "" : ", ") + names[begin];
    if (end - begin > 1) text += " to " + std::to_string(first + end - begin - 1);
  }
  return text;
}

class Verification {
 public:
  explicit Verification(const fs::path& folder) : folder_(folder) {}

  VerifyReport run() {
    guarded([&] { plan_ = read_plan(); });
    guarded([&] { read_records(); });
    guarded([&] { check_fixed_files(); });
    guarded([&] { check_pictures(); });
    guarded([&] { check_refused(); });
    guarded([&] { check_extra_files(); });
    guarded([&] { check_steps(); });
    check_end();
    check_manifests();
    return report_;
  }

 private:
  template <typename Check>
  void guarded(const Check& check) {
    try {
      check();
    } catch (const std::exception& error) {
      problem(problem_line(error));
    }
  }

  void problem(const std::string& line) { report_.problems.push_back(line); }

  Plan read_plan() const {
    const fs::path file = folder_ / "session.json";
    const json session = read_json_file(file);
    ObjectReader reader(session, file.string(), "session");
    return plan_from_json(reader.raw("plan"), file.string());
  }

  void read_records() {
    const JournalText journal = read_journal(folder_ / "journal.jsonl");
    records_ = journal.records;
    report_.records = records_.size();
    if (journal.torn_bytes > 0) {
      problem("journal.jsonl ends with a torn line of " + std::to_string(journal.torn_bytes) +
              " bytes; resume the session");
    }
    taken_ = taken_pictures(records_);
  }

  // True when the file is there, is a file, and has the hash.
  bool check_file(const std::string& name, const std::string& sha256) {
    const fs::path file = folder_ / name;
    if (!fs::is_regular_file(fs::symlink_status(file))) {
      problem(name + " is missing");
      return false;
    }
    ++report_.files;
    if (sha256_of_file(file) != sha256) {
      problem(name + " differs from its journalled hash");
      return false;
    }
    return true;
  }

  void check_fixed_files() {
    const auto start = std::find_if(records_.begin(), records_.end(),
                                    [](const JournalRecord& record) { return record.event == "start"; });
    if (start == records_.end()) {
      problem("journal.jsonl has no start; resume the session");
      return;
    }
    const std::map<std::string, std::string> fixed = fixed_files(records_);
    for (const auto& [name, sha256] : fixed) check_file(name, sha256);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "calibration")) {
      const std::string name = "calibration/" + entry.path().filename().string();
      if (!fixed.contains(name)) problem(name + " is not named in the journal");
    }
  }

  // A dark may share the file of another.
  void check_pictures() {
    std::map<std::string, bool> holds;
    for (const auto& [step, picture] : taken_) {
      if (!holds.contains(picture.file)) holds[picture.file] = check_file(picture.file, picture.sha256);
      if (holds.at(picture.file)) good_steps_.insert(step);
    }
    report_.pictures = good_steps_.size();
  }

  void check_refused() {
    for (const JournalRecord& record : records_)
      if (record.event == "refused" && record.data.contains("file"))
        check_file(record.data.at("file").get<std::string>(), record.data.at("sha256").get<std::string>());
  }

  void check_extra_files() {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "raw")) {
      const std::string name = "raw/" + entry.path().filename().string();
      const bool named =
          std::any_of(taken_.begin(), taken_.end(), [&](const auto& taken) { return taken.second.file == name; });
      if (!named) problem(name + " is not named in the journal");
    }
  }

  void check_steps() {
    if (!plan_) return;
    report_.views_planned = view_count(*plan_);
    std::size_t needed = 0;
    std::vector<std::string> missing;
    for (const PlanStep& step : plan_->steps) {
      const bool good = good_steps_.contains(step.id);
      report_.views += good && step.kind == StepKind::view ? 1U : 0U;
      needed += is_needed(step, taken_) || taken_.contains(step.id) ? 1U : 0U;
      if (!taken_.contains(step.id) && is_needed(step, taken_)) missing.push_back(step.id);
    }
    if (!missing.empty()) {
      problem((missing.size() == 1 ? "step " : std::to_string(missing.size()) + " steps have no picture: ") +
              enumerated(missing) + (missing.size() == 1 ? " has no picture" : "") + "; resume the session");
    }
    for (const auto& [step, picture] : taken_)
      if (find_step(*plan_, step) == nullptr)
        problem(picture.file + " belongs to the step " + step + ", which the plan does not have");
    report_.complete = good_steps_.size() == needed && !records_.empty() && ends_complete();
  }

  // An upgrade of its files comes after the end of a session.
  bool ends_complete() const {
    const auto last = std::find_if(records_.rbegin(), records_.rend(),
                                   [](const JournalRecord& record) { return record.event != "upgraded"; });
    return last != records_.rend() && last->event == "stop" && last->data.value("outcome", std::string()) == "complete";
  }

  void check_end() {
    report_.state = state_of(records_, folder_in_use(folder_));
    if (records_.empty() || !ends_complete())
      problem("the session is " + state_name(report_.state) + ", not complete; resume it");
  }

  void check_manifests() {
    for (const char* name : {"linear", "masks", "result"}) {
      const ManifestReport manifest = check_manifest(folder_ / name);
      report_.files += manifest.files;
      report_.problems.insert(report_.problems.end(), manifest.problems.begin(), manifest.problems.end());
    }
  }

  fs::path folder_;
  VerifyReport report_;
  std::optional<Plan> plan_;
  std::vector<JournalRecord> records_;
  std::map<std::string, PictureRecord> taken_;
  std::set<std::string> good_steps_;
};

}  // namespace

std::map<std::string, std::string> fixed_files(const std::vector<JournalRecord>& records) {
  std::map<std::string, std::string> files;
  for (const JournalRecord& record : records)
    if (record.event == "start" || record.event == "upgraded")
      for (const auto& [name, sha256] : record.data.at("files").items()) files[name] = sha256;
  return files;
}

VerifyReport verify_session(const fs::path& folder) {
  if (!is_session(folder))
    throw std::runtime_error("'" + folder.string() + "' is no session (it has no session.json); check the path");
  return Verification(folder).run();
}

}  // namespace station
