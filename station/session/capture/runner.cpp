#include "station/session/capture/runner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "calibration/sensor/median.h"
#include "rig/devices/tracked_turntable.h"
#include "station/bench/bench_fault.h"
#include "station/documents/degree.h"
#include "station/session/capture/delivered_pictures.h"
#include "station/session/capture/open_steps.h"
#include "station/session/capture/recorder.h"
#include "station/session/capture/turn_ahead.h"
#include "station/session/record/picture_record.h"

namespace station {
namespace {

struct Stopped {  // thrown by poll(), caught in run_plan only
  StopWish wish;
};

// Findings (verdict.h) of what may have been wrong before it was seen.
constexpr std::array kLasting = {"angle", "bench", "lamp", "focus"};

// Findings of what is no spool's: the platform slipped, camera or table were moved.
constexpr std::array kOfTheBench = {"angle", "bench"};

[[noreturn]] void give_up(const Verdict& verdict) {
  const auto of_the_bench = [](const Finding& finding) {
    return finding.grade == Grade::bad && std::ranges::find(kOfTheBench, finding.check) != kOfTheBench.end();
  };
  if (std::ranges::any_of(verdict.findings, of_the_bench)) throw BenchFault(verdict.reason());
  throw std::runtime_error(verdict.reason());
}

class CaptureRun {
 public:
  CaptureRun(const Plan& plan, const RunDevices& devices, Recorder& recorder, const RunOptions& options)
      : plan_(plan), devices_(devices), recorder_(recorder), options_(options), ahead_(devices.turntable) {}

  void go() {
    require_known_steps();
    recorder_.begin(plan_);
    remember_order();
    take_back();
    poll();
    bool ready = false;
    // Searched anew after each step: a picture taken again may have made a dark stale that was passed before.
    for (Plan open = left(); !open.steps.empty(); open = left()) {
      const PlanStep& step = open.steps.front();
      report(step.id);
      poll();
      if (!ready) {
        prepare_devices();
        ready = true;
      }
      const double began_s = devices_.clock.monotonic_s();
      if (const auto dark = dark_that_serves(step, recorder_.taken())) {
        remove_stale(step);
        recorder_.keep_same(*dark, step.id);
      } else {
        take(step);
        durations_s_.push_back(devices_.clock.monotonic_s() - began_s);
      }
    }
    report("");
  }

 private:
  StopWish wish() const { return options_.stop_wish ? options_.stop_wish() : StopWish::none; }

  void poll() const {
    if (const StopWish now = wish(); now != StopWish::none) throw Stopped{now};
  }

  void require_known_steps() const {
    for (const std::string& step : options_.reshoot) {
      if (find_step(plan_, step) == nullptr) {
        throw std::runtime_error("'" + step +
                                 "' was to be taken again and is no step of the plan; see its session.json");
      }
    }
  }

  void remember_order() {
    std::vector<std::pair<std::string, std::string>> pictures;  // when, which step
    for (const auto& [step, picture] : recorder_.taken()) pictures.emplace_back(picture.utc, step);
    std::ranges::sort(pictures);
    for (const auto& [utc, step] : pictures) order_.push_back(step);
  }

  void take_back() {
    for (const std::string& step : options_.reshoot)
      if (recorder_.taken().contains(step)) recorder_.withdraw(step, "it was asked to be taken again");
  }

  // The steps that are still open.
  Plan left() const { return open_steps(plan_, recorder_.taken()); }

  void prepare_devices() {
    recorder_.camera(devices_.camera.identity());
    devices_.turntable.home();
  }

  void take(const PlanStep& step) {
    remove_stale(step);
    arrange(step);
    for (int attempt = 1;; ++attempt) {
      PictureRecord record = record_of(step);
      record.read_angle_rad = turn(step.platform_angle_rad);
      record.asked = set_camera(devices_.camera, exposure_for(step));
      let_lamp_settle(step);
      poll();
      const rig::Picture delivered = devices_.camera.capture();
      turn_ahead(step);
      record.verdict = judge(step, record, delivered);
      if (options_.judged) options_.judged(step, record.verdict);
      if (record.verdict.grade() != Grade::bad) {
        place_settled_ = place_settled_ || record.verdict.find("angle") != nullptr;
        recorder_.keep(record, delivered);
        ahead_.wait();
        order_.push_back(step.id);
        return;
      }
      recorder_.refused(step, record.verdict, delivered);
      ahead_.wait();
      if (settle_place(record.verdict)) continue;
      withdraw_doubted(record.verdict);
      if (!record.verdict.may_pass_again() || attempt >= options_.most_attempts) give_up(record.verdict);
      poll();
    }
  }

  // A turntable without a home switch believes what it remembers. The platform's first tags prove it, or set it right.
  bool settle_place(const Verdict& verdict) {
    const Finding* angle = verdict.find("angle");
    if (angle == nullptr || !angle->value || std::exchange(place_settled_, true) || !options_.settle_place)
      return false;
    const double reading_rad = devices_.turntable.angle_rad();
    const std::optional<double> stands_rad = options_.settle_place(reading_rad, *angle->value * kDegree);
    if (stands_rad) devices_.turntable.stands_at(*stands_rad);
    return stands_rad.has_value();
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

  // Withdraws the picture of a dark or a bracket's exposure whose view was taken again at another exposure.
  void remove_stale(const PlanStep& step) {
    const auto found = recorder_.taken().find(step.id);
    if (found != recorder_.taken().end() && found->second.same_as.empty())
      recorder_.withdraw(step.id, "its view was taken again with another exposure");
  }

  // Withdraws the views since the last one that showed the contrary: what was found now may have happened before them.
  void withdraw_doubted(const Verdict& verdict) {
    for (const Finding& finding : verdict.findings) {
      if (finding.grade != Grade::bad || std::ranges::find(kLasting, finding.check) == kLasting.end()) continue;
      for (auto step = order_.rbegin(); step != order_.rend(); ++step) {
        const auto found = recorder_.taken().find(*step);
        if (found == recorder_.taken().end() || found->second.kind == StepKind::dark) continue;
        const Finding* before = found->second.verdict.find(finding.check);
        if (before != nullptr && before->value && before->grade != Grade::bad) break;
        recorder_.withdraw(*step,
                           "since the view before it nothing shows that this had not happened yet: " + finding.reason);
      }
    }
  }

  rig::Arrangement arrangement_of(const PlanStep& step) const {
    return {.object = options_.object,
            .mounting = step.mounting,
            .on_platform = true,
            .pose = options_.nominal_holder_pose(step.mounting),
            .lamp = step.lamp,
            .room_light = step.room_light};
  }

  void arrange(const PlanStep& step) {
    const rig::Arrangement wanted = arrangement_of(step);
    if (!standing_ || !rig::same_arrangement(*standing_, wanted)) {
      poll();
      lamp_cold_ = wanted.lamp != rig::Lamp::off && (lamp_cold_ || !standing_ || standing_->lamp == rig::Lamp::off);
      standing_.reset();
      devices_.person.arrange(wanted);
      standing_ = wanted;
      recorder_.arranged(step);
    }
    poll();
  }

  // A lamp that was on all the time is warm, wherever it was moved to.
  void let_lamp_settle(const PlanStep& step) {
    if (!lamp_cold_ || step.kind != StepKind::view || !options_.read_lamp || !(options_.lamp_watch.interval_s > 0))
      return;
    const ReadLamp read = [this](const PlanStep& lit, const rig::Picture& test) {
      delivered_.add_test(test);
      return options_.read_lamp(lit, test);
    };
    recorder_.lamp_watched(
        step, watch_lamp(
                  devices_.camera, devices_.clock, step, options_.lamp_watch, read, [this] { poll(); }, options_.said));
    lamp_cold_ = false;
  }

  // Turns to the step after this one, whose picture is on its way, unless a person has to be asked for something first.
  void turn_ahead(const PlanStep& step) {
    if (!options_.turn_ahead) return;
    const Plan open = left();
    const auto next = std::ranges::find_if(open.steps, [&](const PlanStep& other) { return other.id != step.id; });
    if (next != open.steps.end() && next->platform_angle_rad != step.platform_angle_rad && standing_ &&
        rig::same_arrangement(*standing_, arrangement_of(*next)) && wish() == StopWish::none)
      ahead_.begin(next->platform_angle_rad);
  }

  double turn(double asked_rad) {
    ahead_.move_to(asked_rad);
    poll();
    const double read_rad = devices_.turntable.angle_rad();
    if (!(std::abs(read_rad - asked_rad) <= options_.angle_tolerance_rad)) {
      throw BenchFault("the platform was asked to turn to " + rig::degrees_text(asked_rad) + " and reads " +
                       rig::degrees_text(read_rad) + "; see that nothing blocks it, then resume");
    }
    return read_rad;
  }

  rig::CameraSettings exposure_for(const PlanStep& step) {
    if (!step.exposure_of.empty()) {
      const rig::CameraSettings settings = repeated_settings(step, recorder_.taken());
      const double offered_s = rig::nearest_shutter_s(devices_.camera.shutter_times_s(), settings.exposure_s);
      if (std::abs(std::log2(offered_s / settings.exposure_s)) > 1.0 / 6) {
        throw std::runtime_error("'" + step.id + "' needs an exposure of " + std::to_string(settings.exposure_s) +
                                 " s, the camera's nearest is " + std::to_string(offered_s) +
                                 " s; move the lamp or change the rig file's bracket_stops");
      }
      return settings;
    }
    if (step.exposure_s) {
      rig::CameraSettings settings = options_.settings;
      settings.exposure_s = *step.exposure_s;
      return settings;
    }
    if (!options_.choose_exposure) return options_.settings;
    const Metering metering = meter_exposure(devices_.camera, step, metering_start(step), watch_tests(),
                                             options_.most_test_pictures, [this] { poll(); });
    recorder_.metered(step, metering);
    return metering.settings;
  }

  // The last picture under the same light is a good guess.
  rig::CameraSettings metering_start(const PlanStep& step) const {
    rig::CameraSettings first = options_.settings;
    for (const PlanStep& other : plan_.steps) {
      const auto found = recorder_.taken().find(other.id);
      if (found != recorder_.taken().end() && other.kind == step.kind && other.lamp == step.lamp)
        first.exposure_s = found->second.asked.exposure_s;
    }
    return first;
  }

  // What the camera delivered for a test counts as delivered too: a camera that answers one picture late is found out.
  ChooseExposure watch_tests() {
    return [this](const PlanStep& step, const rig::Picture& test) {
      delivered_.add_test(test);
      return options_.choose_exposure(step, test);
    };
  }

  Verdict judge(const PlanStep& step, const PictureRecord& record, const rig::Picture& delivered) {
    Verdict verdict = delivered_.check(record, delivered, recorder_.taken());
    if (verdict.grade() == Grade::bad || !options_.inspect) return verdict;
    try {
      verdict.add(options_.inspect(step, delivered, record.read_angle_rad));
      require_verified(step, verdict);
    } catch (const std::exception& error) {
      verdict.findings.push_back({.check = "file", .grade = Grade::bad, .value = {}, .reason = error.what()});
    }
    return verdict;
  }

  // Refuses a picture in which nothing shows what the plan wants verified; a bad one has its reason already.
  static void require_verified(const PlanStep& step, Verdict& verdict) {
    if (verdict.grade() == Grade::bad) return;
    for (const std::string& check : step.verify)
      if (verdict.find(check) == nullptr)
        verdict.findings.push_back({.check = "verify",
                                    .grade = Grade::bad,
                                    .value = {},
                                    .reason = "'" + step.id + "' is to be verified for '" + check +
                                              "' by the plan, and nothing in the picture shows it; see that what "
                                              "shows it stands free and lit, or take it out of the plan's verify"});
  }

  void report(const std::string& step) const {
    if (!options_.progress) return;
    const Plan open = left();
    const double seconds_left = durations_s_.empty()
                                    ? estimated_duration_s(open, options_.durations)
                                    : calibration::median(durations_s_) * static_cast<double>(open.steps.size());
    options_.progress({.done = plan_.steps.size() - open.steps.size(),
                       .total = plan_.steps.size(),
                       .step = step,
                       .seconds_left = seconds_left,
                       .state = wish() == StopWish::pause ? RunState::pausing : RunState::running});
  }

  const Plan& plan_;
  const RunDevices& devices_;
  Recorder& recorder_;
  const RunOptions& options_;
  bool place_settled_ = false;                // a picture's tags have shown where the platform stands
  bool lamp_cold_ = false;                    // switched on since the last view
  std::optional<rig::Arrangement> standing_;  // unknown at the beginning: somebody may have been there
  std::vector<std::string> order_;            // steps in the order of their pictures
  DeliveredPictures delivered_;               // in this run
  std::vector<double> durations_s_;           // of this run's steps
  TurnAhead ahead_;                           // last: its way ends before what it is reported to
};

// Stopping must not hide why: what fails here is left to the error that is under way.
template <typename Work>
void quietly(const Work& work) noexcept {
  try {
    work();
  } catch (...) {
  }
}

}  // namespace

RunState run_plan(const Plan& plan, const RunDevices& devices, SessionFolder& session, const RunOptions& options) {
  if (const std::optional<std::string> problem = check_plan(plan)) throw std::runtime_error(*problem);
  Recorder recorder(session);
  const auto leave = [&] { quietly([&] { devices.turntable.stop(); }); };
  const auto stop = [&](StopWish wish) {
    const RunState state = wish == StopWish::now ? RunState::aborted : RunState::paused;
    quietly([&] { recorder.stop(state); });
    leave();
    return state;
  };
  try {
    CaptureRun(plan, devices, recorder, options).go();
    recorder.stop(RunState::complete);
    return RunState::complete;
  } catch (const Stopped& stopped) {
    return stop(stopped.wish);
  } catch (const RecordingFailed& error) {
    quietly([&] { recorder.stop(RunState::failed, error.what()); });
    leave();
    throw;
  } catch (const std::exception& error) {
    // Ctrl-C stops the platform from another thread, and the move that it ended throws.
    if (const StopWish wish = options.stop_wish ? options.stop_wish() : StopWish::none; wish != StopWish::none)
      return stop(wish);
    quietly([&] { recorder.stop(RunState::suspended, error.what()); });
    leave();
    throw;
  }
}

}  // namespace station
