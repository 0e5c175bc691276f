#include "station/session/capture/recorder.h"

#include <algorithm>
#include <filesystem>

#include "station/documents/disk/sha256.h"
#include "station/documents/plan_file.h"

namespace station {
namespace {

template <typename Work>
auto durably(const Work& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    throw RecordingFailed(error.what());
  }
}

const JournalRecord* first_record(const SessionFolder& session, const std::string& event) {
  const auto found = std::find_if(session.records().begin(), session.records().end(),
                                  [&](const JournalRecord& record) { return record.event == event; });
  return found == session.records().end() ? nullptr : &*found;
}

}  // namespace

void Recorder::begin(const Plan& plan) {
  const std::string hash = sha256_hex(plan_to_json(plan).dump());
  const JournalRecord* start = first_record(session_, "start");
  if (start != nullptr && start->data.value("plan_sha256", std::string()) != hash) {
    throw std::runtime_error("the session '" + session_.path().string() +
                             "' was started with another plan; resume it with its own, or start a new session");
  }
  durably([&] {
    if (start == nullptr)
      session_.append("start", {{"plan_sha256", hash}, {"files", session_.hashes_of_fixed_files()}});
    else
      session_.append("resume", {{"plan_sha256", hash}});
  });
  keep_what_verifies();
}

void Recorder::keep_what_verifies() {
  taken_ = durably([&] { return taken_pictures(session_.records()); });
  const auto taken = taken_;  // discarding changes taken_
  for (const auto& [step, picture] : taken)
    if (taken_.contains(step) && !verifies(picture))
      discard(picture.file, "the file is missing or differs from its journalled hash");
  for (const std::string& name : session_.picture_names()) {
    const std::string file = "raw/" + name;
    const bool named =
        std::any_of(taken_.begin(), taken_.end(), [&](const auto& entry) { return entry.second.file == file; });
    if (!named) discard(file, "the journal does not name it");
  }
}

bool Recorder::verifies(const PictureRecord& picture) const {
  const std::filesystem::path file = session_.path() / picture.file;
  return std::filesystem::is_regular_file(std::filesystem::symlink_status(file)) &&
         sha256_of_file(file) == picture.sha256;
}

void Recorder::discard(const std::string& file, const std::string& reason) {
  durably([&] {
    session_.append("discarded", {{"file", file}, {"reason", reason}});
    session_.set_aside(std::filesystem::path(file).filename().string());
  });
  forget_file(taken_, file);
}

void Recorder::withdraw(const std::string& step, const std::string& reason) {
  const std::string file = taken_.at(step).file;
  discard(file, reason);
}

void Recorder::camera(const rig::CameraIdentity& identity) {
  const JournalRecord* before = first_record(session_, "camera");
  if (before != nullptr && before->data.value("serial", std::string()) != identity.serial) {
    throw std::runtime_error("the session was begun with the camera " + before->data.value("serial", std::string()) +
                             " and " + identity.serial + " is connected; connect the first, or start a new session");
  }
  durably([&] {
    session_.append("camera", {{"make", identity.make},
                               {"model", identity.model},
                               {"serial", identity.serial},
                               {"width_px", identity.width_px},
                               {"height_px", identity.height_px}});
  });
}

void Recorder::arranged(const PlanStep& step) {
  durably([&] {
    session_.append("arranged", {{"step", step.id},
                                 {"mounting", mounting_name(step.mounting)},
                                 {"lamp", lamp_name(step.lamp)},
                                 {"room_light", step.room_light}});
  });
}

void Recorder::lamp_watched(const PlanStep& step, const LampSettling& settling) {
  nlohmann::json data = {{"step", step.id}, {"test_pictures", settling.test_pictures}, {"waited_s", settling.waited_s}};
  if (settling.change) data["change"] = three_digits(*settling.change);
  durably([&] {
    session_.append("lamp_watch", data);
    if (!settling.readable) session_.append("warning", {{"step", step.id}, {"message", kLampNotWatched}});
  });
}

void Recorder::metered(const PlanStep& step, const Metering& metering) {
  durably([&] {
    session_.append("metering", {{"step", step.id},
                                 {"exposure_s", metering.settings.exposure_s},
                                 {"test_pictures", metering.test_pictures},
                                 {"converged", metering.converged}});
    if (!metering.converged)
      session_.append("warning", {{"step", step.id}, {"message", "the metering did not settle; look at the exposure"}});
  });
}

void Recorder::refused(const PlanStep& step, const Verdict& verdict, const rig::Picture& picture) {
  durably([&] {
    nlohmann::json data = {{"step", step.id}, {"verdict", verdict_to_json(verdict)}};
    if (!picture.bytes.empty()) {
      const auto [file, sha256] = session_.store_refused(step.id + "." + picture.extension, picture.bytes);
      data["file"] = file;
      data["sha256"] = sha256;
    }
    session_.append("refused", data);
  });
}

void Recorder::keep(PictureRecord record, const rig::Picture& picture) {
  durably([&] {
    const std::string name = record.step + "." + picture.extension;
    record.file = "raw/" + name;
    record.bytes = picture.bytes.size();
    record.read = picture.settings;
    record.utc = picture.utc;
    record.sha256 = session_.store_picture(name, picture.bytes);
    session_.append("picture", picture_to_json(record));
  });
  const std::string step = record.step;
  taken_.insert_or_assign(step, std::move(record));
}

void Recorder::keep_same(PictureRecord record, const std::string& step) {
  record.same_as = record.step;
  record.step = step;
  durably([&] { session_.append("picture", picture_to_json(record)); });
  taken_.insert_or_assign(step, std::move(record));
}

void Recorder::stop(RunState outcome, const std::string& message) {
  nlohmann::json data = {{"outcome", state_name(outcome)}};
  if (!message.empty()) data["message"] = message;
  durably([&] { session_.append("stop", data); });
}

}  // namespace station
