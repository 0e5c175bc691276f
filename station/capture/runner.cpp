#include "station/capture/runner.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "station/capture/picture_record.h"
#include "station/capture/plan_file.h"
#include "station/capture/sha256.h"

namespace station {
namespace {

using nlohmann::json;

struct Interrupted {};  // thrown by poll(), caught in run_plan only

std::string plan_hash(const Plan& plan) {
  return sha256_hex(plan_to_json(plan).dump());
}

const JournalRecord* first_record(const SessionFolder& session, const std::string& event) {
  const auto found = std::find_if(session.records().begin(), session.records().end(),
                                  [&](const JournalRecord& record) { return record.event == event; });
  return found == session.records().end() ? nullptr : &*found;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string degrees(double angle_rad) {
  return std::to_string(angle_rad * 180 / std::numbers::pi) + " deg";
}

class CaptureRun {
 public:
  CaptureRun(const Plan& plan, const RunDevices& devices, SessionFolder& session, const RunOptions& options)
      : plan_(plan), devices_(devices), session_(session), options_(options) {}

  void go() {
    open_records();
    keep_what_verifies();
    poll();
    bool ready = false;
    while (const PlanStep* step = first_open_step()) {
      report(step->id);
      poll();
      if (!ready) {
        prepare_devices();
        ready = true;
      }
      const double began_s = devices_.clock.monotonic_s();
      if (!reuse_dark(*step)) {
        take(*step);
        durations_s_.push_back(devices_.clock.monotonic_s() - began_s);
      }
    }
    report("");
  }

 private:
  void poll() const {
    if (options_.should_stop && options_.should_stop()) {
      throw Interrupted{};
    }
  }

  void open_records() {
    const std::string hash = plan_hash(plan_);
    const JournalRecord* start = first_record(session_, "start");
    if (start == nullptr) {
      session_.append("start", {{"plan_sha256", hash}, {"files", session_.hashes_of_fixed_files()}});
      return;
    }
    if (start->data.value("plan_sha256", std::string()) != hash) {
      throw std::runtime_error("the session '" + session_.path().string() +
                               "' was started with another plan; resume it with its own, or start a new session");
    }
    session_.append("resume", {{"plan_sha256", hash}});
  }

  void keep_what_verifies() {
    taken_ = taken_pictures(session_.records());
    const auto taken = taken_;  // discarding changes taken_
    for (const auto& [step, picture] : taken) {
      if (taken_.contains(step) && !verifies(picture)) {
        discard(picture.file, "the file is missing or differs from its journalled hash");
      }
    }
    for (const std::string& name : session_.picture_names()) {
      const std::string file = "raw/" + name;
      const bool named =
          std::any_of(taken_.begin(), taken_.end(), [&](const auto& entry) { return entry.second.file == file; });
      if (!named) {
        discard(file, "the journal does not name it");
      }
    }
  }

  bool verifies(const PictureRecord& picture) const {
    const std::filesystem::path file = session_.path() / picture.file;
    return std::filesystem::is_regular_file(std::filesystem::symlink_status(file)) &&
           sha256_of_file(file) == picture.sha256;
  }

  void discard(const std::string& file, const std::string& reason) {
    session_.append("discarded", {{"file", file}, {"reason", reason}});
    session_.remove_picture(std::filesystem::path(file).filename().string());
    forget_file(taken_, file);
  }

  // Searched anew after each step: a picture taken again may have made a dark stale that was passed before.
  const PlanStep* first_open_step() const {
    const auto found =
        std::find_if(plan_.steps.begin(), plan_.steps.end(), [&](const PlanStep& step) { return !is_done(step); });
    return found == plan_.steps.end() ? nullptr : &*found;
  }

  bool is_done(const PlanStep& step) const {
    const auto found = taken_.find(step.id);
    if (found == taken_.end() || step.exposure_of.empty()) {
      return found != taken_.end();
    }
    return taken_.contains(step.exposure_of) && same_settings(found->second.asked, repeated_settings(step));
  }

  // Of a dark or of a bracket's exposure: its view's, so many stops longer.
  rig::ExposureSettings repeated_settings(const PlanStep& step) const {
    rig::ExposureSettings settings = taken_.at(step.exposure_of).asked;
    settings.exposure_s *= std::exp2(step.stops);
    return settings;
  }

  void prepare_devices() {
    const rig::CameraIdentity camera = devices_.camera.identity();
    const JournalRecord* before = first_record(session_, "camera");
    if (before != nullptr && before->data.value("serial", std::string()) != camera.serial) {
      throw std::runtime_error("the session was begun with the camera " +
                               before->data.value("serial", std::string()) + " and " + camera.serial +
                               " is connected; connect the first, or start a new session");
    }
    session_.append("camera", {{"make", camera.make},
                               {"model", camera.model},
                               {"serial", camera.serial},
                               {"width_px", camera.width_px},
                               {"height_px", camera.height_px}});
    devices_.turntable.home();
  }

  // A dark of the same exposure that was taken already serves.
  bool reuse_dark(const PlanStep& step) {
    if (step.kind != StepKind::dark) {
      return false;
    }
    const rig::ExposureSettings wanted = repeated_settings(step);
    for (const auto& [id, picture] : taken_) {
      if (id != step.id && picture.kind == StepKind::dark && picture.same_as.empty() &&
          same_settings(picture.asked, wanted)) {
        remove_stale(step);
        PictureRecord same = picture;
        same.step = step.id;
        same.same_as = id;
        session_.append("picture", picture_to_json(same));
        taken_.insert_or_assign(step.id, same);
        return true;
      }
    }
    return false;
  }

  void take(const PlanStep& step) {
    remove_stale(step);
    arrange(step);
    PictureRecord picture = record_of(step);
    picture.read_angle_rad = turn(step.platform_angle_rad);
    picture.asked = set_camera(devices_.camera, exposure_for(step));
    poll();
    const rig::Picture delivered = devices_.camera.capture();
    check(step, picture.asked, delivered);
    if (options_.inspect) {
      options_.inspect(step, delivered, picture.read_angle_rad);
    }
    const std::string name = step.id + "." + delivered.extension;
    picture.file = "raw/" + name;
    picture.bytes = delivered.bytes.size();
    picture.read = delivered.settings;
    picture.utc = delivered.utc;
    picture.sha256 = session_.store_picture(name, delivered.bytes);
    session_.append("picture", picture_to_json(picture));
    taken_.insert_or_assign(step.id, picture);
  }

  static PictureRecord record_of(const PlanStep& step) {
    PictureRecord picture;
    picture.step = step.id;
    picture.kind = step.kind;
    picture.mounting = step.mounting;
    picture.lamp = step.lamp;
    picture.room_light = step.room_light;
    picture.asked_angle_rad = step.platform_angle_rad;
    return picture;
  }

  // A dark or a bracket's exposure whose view was taken again at another exposure.
  void remove_stale(const PlanStep& step) {
    const auto found = taken_.find(step.id);
    if (found != taken_.end() && found->second.same_as.empty()) {
      const std::string file = found->second.file;
      discard(file, "its view was taken again with another exposure");
    }
  }

  void arrange(const PlanStep& step) {
    const rig::Arrangement wanted{.object = rig::BenchObject::holder,
                                  .mounting = step.mounting,
                                  .on_platform = true,
                                  .pose = options_.nominal_holder_pose(step.mounting),
                                  .lamp = step.lamp,
                                  .room_light = step.room_light};
    if (!standing_ || !rig::same_arrangement(*standing_, wanted)) {
      poll();
      standing_.reset();
      devices_.person.arrange(wanted);
      standing_ = wanted;
      session_.append("arranged", {{"step", step.id},
                                   {"mounting", mounting_name(step.mounting)},
                                   {"lamp", lamp_name(step.lamp)},
                                   {"room_light", step.room_light}});
    }
    poll();
  }

  double turn(double asked_rad) {
    devices_.turntable.move_to(asked_rad);
    poll();
    const double read_rad = devices_.turntable.angle_rad();
    if (!(std::abs(read_rad - asked_rad) <= options_.angle_tolerance_rad)) {
      throw std::runtime_error("the platform was asked to turn to " + degrees(asked_rad) + " and reads " +
                               degrees(read_rad) + "; see that nothing blocks it, then resume");
    }
    return read_rad;
  }

  rig::ExposureSettings exposure_for(const PlanStep& step) {
    if (!step.exposure_of.empty()) {
      const rig::ExposureSettings settings = repeated_settings(step);
      const double offered_s = rig::nearest_shutter_s(devices_.camera.shutter_times_s(), settings.exposure_s);
      if (std::abs(std::log2(offered_s / settings.exposure_s)) > 1.0 / 6) {
        throw std::runtime_error("'" + step.id + "' needs an exposure of " + std::to_string(settings.exposure_s) +
                                 " s, the camera's nearest is " + std::to_string(offered_s) +
                                 " s; move the lamp or change the rig file's bracket_stops");
      }
      return settings;
    }
    if (!options_.choose_exposure) {
      return options_.settings;
    }
    const Metering metering = meter_exposure(devices_.camera, step, metering_start(step), options_.choose_exposure,
                                             options_.most_test_pictures, [this] { poll(); });
    session_.append("metering", {{"step", step.id},
                                 {"exposure_s", metering.settings.exposure_s},
                                 {"test_pictures", metering.test_pictures},
                                 {"converged", metering.converged}});
    if (!metering.converged) {
      session_.append("warning",
                      {{"step", step.id}, {"message", "the metering did not settle; look at the exposure"}});
    }
    return metering.settings;
  }

  // The last picture under the same light is a good guess.
  rig::ExposureSettings metering_start(const PlanStep& step) const {
    rig::ExposureSettings first = options_.settings;
    for (const PlanStep& other : plan_.steps) {
      const auto found = taken_.find(other.id);
      if (found != taken_.end() && other.kind == step.kind && other.lamp == step.lamp) {
        first.exposure_s = found->second.asked.exposure_s;
      }
    }
    return first;
  }

  void check(const PlanStep& step, const rig::ExposureSettings& asked, const rig::Picture& delivered) const {
    if (delivered.bytes.empty()) {
      throw std::runtime_error("the camera delivered an empty picture for '" + step.id +
                               "'; check its card and cable, then resume");
    }
    if (!same_settings(asked, delivered.settings)) {
      throw std::runtime_error("the picture '" + step.id + "' was to be taken with " + settings_text(asked) +
                               " and says " + settings_text(delivered.settings) +
                               "; set the camera's dial to M (manual), then resume");
    }
    const std::string hash = sha256_hex(delivered.bytes);
    const auto same =
        std::find_if(taken_.begin(), taken_.end(), [&](const auto& entry) { return entry.second.sha256 == hash; });
    if (same != taken_.end()) {
      throw std::runtime_error("the camera delivered the picture of '" + same->first + "' again for '" + step.id +
                               "'; switch it off and on, then resume");
    }
  }

  void report(const std::string& step) const {
    if (!options_.progress) {
      return;
    }
    Plan left;
    std::copy_if(plan_.steps.begin(), plan_.steps.end(), std::back_inserter(left.steps),
                 [&](const PlanStep& other) { return !is_done(other); });
    const double seconds_left = durations_s_.empty() ? estimated_duration_s(left, options_.durations)
                                                     : median(durations_s_) * static_cast<double>(left.steps.size());
    options_.progress({.done = plan_.steps.size() - left.steps.size(),
                       .total = plan_.steps.size(),
                       .step = step,
                       .seconds_left = seconds_left});
  }

  const Plan& plan_;
  const RunDevices& devices_;
  SessionFolder& session_;
  const RunOptions& options_;
  std::map<std::string, PictureRecord> taken_;  // by step
  std::optional<rig::Arrangement> standing_;    // unknown at the beginning: somebody may have been there
  std::vector<double> durations_s_;             // of this run's steps
};

// Stopping must not hide why: what fails here is left to the error that is under way.
void stop_platform(rig::Turntable& turntable) noexcept {
  try {
    turntable.stop();
  } catch (...) {
  }
}

void record_failure(SessionFolder& session, const std::string& message) noexcept {
  try {
    session.append("stop", {{"outcome", "failed"}, {"message", message}});
  } catch (...) {
  }
}

RunOutcome interrupt(const RunDevices& devices, SessionFolder& session) {
  stop_platform(devices.turntable);
  session.append("stop", {{"outcome", "interrupted"}});
  return RunOutcome::interrupted;
}

}  // namespace

RunOutcome run_plan(const Plan& plan, const RunDevices& devices, SessionFolder& session, const RunOptions& options) {
  if (const std::optional<std::string> problem = check_plan(plan)) {
    throw std::runtime_error(*problem);
  }
  try {
    CaptureRun(plan, devices, session, options).go();
    session.append("stop", {{"outcome", "complete"}});
    return RunOutcome::complete;
  } catch (const Interrupted&) {
    return interrupt(devices, session);
  } catch (const std::exception& error) {
    stop_platform(devices.turntable);
    // Ctrl-C stops the platform from another thread, and the move that it ended throws.
    if (options.should_stop && options.should_stop()) {
      return interrupt(devices, session);
    }
    record_failure(session, error.what());
    throw;
  }
}

}  // namespace station
