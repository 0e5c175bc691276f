#include "station/session/checks/capture_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "calibration/develop/develop.h"
#include "calibration/develop/linear_grey.h"
#include "calibration/develop/polygon_mask.h"
#include "calibration/sensor/median.h"
#include "calibration/sensor/sensor_maps.h"
#include "station/bench/bench_fault.h"
#include "station/bench/bench_reading.h"
#include "station/bench/calibration_validity.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/bench/exposure.h"
#include "station/bench/metering.h"
#include "station/bench/mounted_holder.h"
#include "station/bench/picture_measures.h"
#include "station/documents/degree.h"
#include "station/documents/number_text.h"
#include "station/documents/plan_file.h"
#include "station/session/checks/lamp_checks.h"
#include "station/session/record/picture_record.h"

namespace station {
namespace {

constexpr double kMostSaturated = 0.05, kSomeSaturated = 0.005, kUnderExposed = 0.02;
constexpr double kLeastSharpness = 0.4, kLittleSharpness = 0.6;  // of the median of the views before
constexpr double kLeastBesideEdges = 0.15;                       // the same where printed edges are as sharp as before
constexpr double kSofter = 1.2;                                  // blur of printed edges over that of the views before
constexpr std::size_t kFewestCompared = 3;
constexpr double kShadowsPercentile = 10;
constexpr double kMostMotion_px = 0.2;
constexpr double kMostTilt_rad = 30 * kDegree;

// The measured exposure time nearest to the wanted one; where none is within 0.6 stops, the wanted one itself.
double nearest_measured_s(const calibration::SensorResponse& response, double wanted_s) {
  double nearest_s = wanted_s, least_stops = 0.6;
  for (const calibration::ShutterTime& time : response.shutter) {
    const double stops = std::abs(std::log2(time.nominal_s / wanted_s));
    if (stops < least_stops) nearest_s = time.nominal_s, least_stops = stops;
  }
  return nearest_s;
}

// A test picture, by which an exposure is chosen. Its tags are found while the camera takes the next picture.
struct TestPicture {
  std::string step;
  calibration::SensorPicture picture;
  std::shared_future<calibration::TagObservation> tags;

  const std::shared_future<calibration::TagObservation>& look() {
    if (!tags.valid())
      tags = std::async(std::launch::async, [seen = std::exchange(picture, {})] { return tags_in(seen); }).share();
    return tags;
  }
};

// One picture as the checks see it.
struct Seen {
  const PlanStep& step;
  const calibration::SensorPicture& raw;
  double reading_rad;
  cv::Mat1f grey;
  calibration::TagObservation tags;
  BenchReading bench;
};

}  // namespace

class CaptureChecks::Work {
 public:
  Work(const SessionFolder& session, const SessionFile& asked, const RigCalibration& calibration, bool in_order)
      : session_(session), asked_(asked), calibration_(calibration), in_order_(in_order), lamp_(asked, calibration_) {
    fill_in_sensor_maps(session.path() / "calibration", calibration_);
    for (const auto& [id, record] : taken_pictures(session.records()))
      if (record.kind == StepKind::view) remember_sharpness(record.lamp, record.mounting, record.verdict);
  }

  // Views are metered on the threads; pose pictures on the whole frame, for the tags.
  ExposureChoice choose(const PlanStep& step, const rig::Picture& test) {
    const calibration::SensorPicture picture = calibration::read_sensor_bytes(test.bytes, "test picture of " + step.id);
    on_bench([&] { require_same_camera(calibration_, picture, "test picture of " + step.id); });
    date_time_ = picture.date_time;
    const cv::Mat1b region = step.kind == StepKind::view ? window(step) : cv::Mat1b();
    const auto next = next_exposure_s(picture, region, {.level = asked_.rig.target_level});
    ExposureChoice choice{.exposure_s = next.value_or(picture.exposure_s), .done = !next};
    if (calibration_.sensor && step.kind == StepKind::view) {
      choice.exposure_s = nearest_measured_s(calibration_.sensor->response, choice.exposure_s);
      choice.done = std::abs(std::log2(choice.exposure_s / picture.exposure_s)) < 0.1;
    }
    // Further test pictures may follow this one: its tags are looked for where they are needed.
    test_ = {.step = step.id, .picture = picture, .tags = {}};
    if (choice.done) test_.look();
    // The bench is checked now, while the holder can still be put right; the runner has checked the reading.
    if (!next && step.kind == StepKind::pose)
      require_calibrated_bench(calibration_, read_bench(calibration_, asked_.rig, test_.look().get()),
                               step.platform_angle_rad, "step " + step.id);
    return choice;
  }

  Verdict judge(const PlanStep& step, const rig::Picture& picture, double reading_rad) {
    verdict_ = {};
    const calibration::SensorPicture raw = calibration::read_sensor_bytes(picture.bytes, "picture of " + step.id);
    check_file(step, picture, raw);
    if (step.kind == StepKind::dark) {
      if (calibration_.sensor) check_dark(step, raw);
      return verdict_;
    }
    if (step.kind == StepKind::bracket) return verdict_;  // its view has been looked at
    Seen seen{.step = step,
              .raw = raw,
              .reading_rad = reading_rad,
              .grey = calibration::linear_grey(raw),
              .tags = {},
              .bench = {}};
    seen.tags = calibration::detect_tags(seen.grey);
    seen.bench = read_bench(calibration_, asked_.rig, seen.tags);
    check_bench(seen);
    check_motion(seen);
    if (step.kind == StepKind::pose) check_pose(seen);
    if (step.kind == StepKind::view) check_view(seen);
    return verdict_;
  }

  std::optional<double> read_lamp(const PlanStep& step, const rig::Picture& test) {
    const calibration::SensorPicture raw = calibration::read_sensor_bytes(test.bytes, "test picture of " + step.id);
    const auto holder_from_world = turned_holder(step.mounting, calibration_.platform.scale * step.platform_angle_rad);
    if (!holder_from_world) return std::nullopt;
    return lamp_.read(step, developer_of(raw), camera_in(*holder_from_world), *holder_from_world);
  }

 private:
  void found(const std::string& check, Grade grade, std::optional<double> value, const std::string& reason = {},
             bool may_pass_again = false) {
    verdict_.findings.push_back({.check = check,
                                 .grade = grade,
                                 .value = value,
                                 .reason = grade == Grade::good ? "" : reason,
                                 .may_pass_again = may_pass_again});
  }

  cv::Mat1b window(const PlanStep& step) const { return metered_region(asked_, calibration_, step); }

  // Checks what the file itself says; the runner has compared the camera's own answers.
  void check_file(const PlanStep& step, const rig::Picture& picture, const calibration::SensorPicture& raw) {
    const rig::CameraSettings written{.exposure_s = raw.exposure_s, .iso = raw.iso, .f_number = raw.f_number};
    if (!same_settings(picture.settings, written))
      found("settings", Grade::bad, std::nullopt,
            "the file of '" + step.id + "' says " + settings_text(written) + ", the camera " +
                settings_text(picture.settings) + "; set its dial to M (manual), then resume",
            true);
    else
      found("settings", Grade::good, std::log2(raw.exposure_s / picture.settings.exposure_s));
    require_same_camera(calibration_, raw, "picture of " + step.id);
    // Of two times such as "2026:11:21 10:20:30", the later is the greater text.
    if (in_order_ && raw.date_time < date_time_)
      found("stale", Grade::bad, std::nullopt,
            "the file of '" + step.id + "' was made at " + raw.date_time +
                ", before the picture that came before it (" + date_time_ +
                "): an old picture; switch the camera off and on, then resume",
            true);
    date_time_ = raw.date_time;  // a clock that was set back is one refused picture
  }

  void check_dark(const PlanStep& step, const calibration::SensorPicture& raw) {
    const double offset = calibration::dark_offset_dn(raw, calibration_.sensor->response.maps) /
                          (raw.white_level_dn - raw.black_level_dn);
    found("dark", offset > calibration::kMostDarkOffset ? Grade::bad : Grade::good, 100 * offset,
          "'" + step.id + "' was to be dark and is " + number_text(100 * offset, 2) +
              " % of the range brighter than the calibration's dark frames; switch the room light and "
              "the lamp off, close the curtain, then resume");
  }

  void check_bench(const Seen& seen) {
    const std::string name = (seen.step.kind == StepKind::pose ? "step " : "view ") + seen.step.id;
    if (seen.bench.shift) {
      const auto problem = calibration::shift_problem(*seen.bench.shift, still_limit_px(calibration_), name);
      const double shift_px = std::max(seen.bench.shift->mean_px.norm(), seen.bench.shift->odd_px);
      found("bench", problem ? Grade::bad : Grade::good, shift_px, problem.value_or(""));
    }
    if (seen.bench.angle) {
      const auto problem = slip_problem(calibration_, seen.bench, seen.reading_rad, name);
      found("angle", problem ? Grade::bad : Grade::good,
            std::remainder(seen.bench.angle->angle_rad - calibration_.platform.scale * seen.reading_rad,
                           2 * std::numbers::pi) /
                kDegree,
            problem.value_or(""));
    }
  }

  void check_motion(const Seen& seen) {
    if (test_.step != seen.step.id) return;
    const auto moved = motion_px(test_.look().get(), seen.tags);
    if (!moved) return;
    found("motion", *moved > kMostMotion_px ? Grade::bad : Grade::good, moved,
          "'" + seen.step.id + "' moved by " + number_text(*moved, 2) + " px since the picture before it (limit " +
              number_text(kMostMotion_px, 1) + "); let the platform come to rest and fasten the holder, then resume",
          true);
  }

  void check_pose(const Seen& seen) {
    const auto blur = edge_blur_px(seen.grey, seen.tags);
    if (blur)
      found("focus",
            *blur > kBadBlur_px        ? Grade::bad
            : *blur > kDoubtfulBlur_px ? Grade::doubtful
                                       : Grade::good,
            blur,
            "'" + seen.step.id + "' is out of focus: printed edges are " + number_text(*blur, 1) +
                " px soft; the lens is calibrated at its taped focus: turn the ring back to it, or focus and "
                "calibrate again");
    std::vector<PosePicture>& posed = posed_[seen.step.mounting];
    std::erase_if(posed, [&](const PosePicture& picture) { return picture.step == seen.step.id; });
    posed.push_back({seen.step.id, seen.reading_rad, seen.tags});
    mounted_.erase(seen.step.mounting);
    const long tags = tags_of_holder(posed.back(), asked_.rig.holder_tags);
    if (tags < kFewestHolderTags) {
      found("tags", Grade::doubtful, static_cast<double>(tags),
            "'" + seen.step.id + "' shows " + std::to_string(tags) + " of the holder's tags, " +
                std::to_string(kFewestHolderTags) + " are needed to develop it; uncover them and take it again");
      return;
    }
    found("tags", Grade::good, static_cast<double>(tags));
    const auto mounted = measure_holder({posed.back()}, calibration_, asked_.rig).platform_from_holder;
    const double tilt_rad = tilt_from(mounted, seen.step.mounting);
    const rig::Mounting other =
        seen.step.mounting == rig::Mounting::horizontal ? rig::Mounting::vertical : rig::Mounting::horizontal;
    found("orientation", tilt_rad > kMostTilt_rad ? Grade::bad : Grade::good, tilt_rad / kDegree,
          "'" + seen.step.id + "' was to show " + mounting_name(seen.step.mounting) + " threads and the holder " +
              (tilt_from(mounted, other) < kMostTilt_rad
                   ? "stands with them " + mounting_name(other)
                   : "stands turned by " + number_text(tilt_rad / kDegree, 0) + " degrees") +
              "; turn the holder, then resume");
  }

  double tilt_from(const Eigen::Isometry3d& mounted, rig::Mounting mounting) const {
    const Eigen::Isometry3d wanted = nominal_holder_pose(asked_.rig, asked_.spool.wrapping, mounting);
    return Eigen::AngleAxisd(Eigen::Matrix3d(wanted.linear().transpose() * mounted.linear())).angle();
  }

  void check_view(const Seen& seen) {
    const std::string name = "'" + seen.step.id + "'";
    const cv::Mat1b region = window(seen.step);
    const double saturated = saturated_fraction(seen.raw, region);
    found("saturation",
          saturated > kMostSaturated   ? Grade::bad
          : saturated > kSomeSaturated ? Grade::doubtful
                                       : Grade::good,
          100 * saturated,
          saturated > kMostSaturated
              ? name + " is over-exposed at " + number_text(seen.raw.exposure_s, 5) +
                    " s: more than 5 % of the threads' window is saturated; move the lamp away, then resume"
              : name + " has " + percent_text(saturated) + " of the threads' window saturated; look at its bracket");
    check_focus(seen, region);
    // A blurred picture of the small chip says nothing about the lamp.
    if (verdict_.findings.back().grade != Grade::bad) check_lamp(seen);
    const double level = bright_level(seen.raw, region, ExposureAim{}.percentile);
    found("exposure", level < kUnderExposed ? Grade::bad : Grade::good, 100 * level,
          name + " is dark: the brightest threads reach " + percent_text(level) + " of the range at " +
              number_text(seen.raw.exposure_s, 3) +
              " s; see that the lamp is on and shines on the threads, then resume");
    found("shadows", Grade::good, 100 * bright_level(seen.raw, region, kShadowsPercentile));
    found("tags", Grade::good, static_cast<double>(seen.tags.size()));
  }

  void check_focus(const Seen& seen, const cv::Mat1b& region) {
    const double here = sharpness(seen.grey, region);
    std::vector<double>& before = sharpness_[{seen.step.lamp, seen.step.mounting}];
    Grade grade = Grade::good;
    double ratio = 1;
    if (before.size() >= kFewestCompared) {
      ratio = here / calibration::median(before);
      grade = ratio < kLeastSharpness ? Grade::bad : ratio < kLittleSharpness ? Grade::doubtful : Grade::good;
      if (grade != Grade::good && edges_are_as_sharp(seen))
        grade = ratio < kLeastBesideEdges ? Grade::doubtful : Grade::good;
    }
    found("focus", grade, here,
          "'" + seen.step.id + "' shows " + percent_text(ratio) + " of the detail of the views before it; " +
              (grade == Grade::bad ? "see that nothing touched the lens or stands before it, then resume"
                                   : "look at it, and take it again with --reshoot if it is soft"));
    if (grade != Grade::bad) before.push_back(here);
  }

  // Threads that face the lamp shade each other less, and thin or glossy ones then have a third of the detail that they
  // have elsewhere. Printed edges beside them have not.
  bool edges_are_as_sharp(const Seen& seen) {
    const std::optional<double> here = edge_blur_px(seen.grey, seen.tags);
    if (!here) return false;
    std::vector<double> before;
    for (const auto& [id, record] : taken_pictures(session_.records())) {
      if (before.size() == kFewestCompared) break;
      if (record.kind != StepKind::view || record.lamp != seen.step.lamp || record.mounting != seen.step.mounting ||
          id == seen.step.id)
        continue;
      const auto [known, unknown] = edge_blurs_px_.try_emplace(record.sha256);
      if (unknown) {
        const cv::Mat1f grey = calibration::linear_grey(calibration::read_sensor_file(session_.path() / record.file));
        known->second = edge_blur_px(grey, calibration::detect_tags(grey));
      }
      if (known->second) before.push_back(*known->second);
    }
    return !before.empty() && *here < kSofter * calibration::median(before);
  }

  void remember_sharpness(rig::Lamp lamp, rig::Mounting mounting, const Verdict& verdict) {
    const Finding* focus = verdict.find("focus");
    if (focus != nullptr && focus->value) sharpness_[{lamp, mounting}].push_back(*focus->value);
  }

  // Develops parts of `raw`, which must outlive the returned function.
  DevelopPart developer_of(const calibration::SensorPicture& raw) const {
    calibration::DevelopOptions options{.vignetting = calibration_.light.vignetting};
    if (calibration_.sensor) options.response = &calibration_.sensor->response;
    return [&raw, options](const cv::Rect& part) mutable {
      options.part = part;
      return calibration::develop(raw, options);
    };
  }

  // The transform holder_from_world; nothing where no pose picture shows the holder.
  std::optional<Eigen::Isometry3d> turned_holder(rig::Mounting mounting, double angle_rad) {
    if (!mounted_.contains(mounting)) mounted_[mounting] = holder_of(mounting);
    const std::optional<Eigen::Isometry3d>& mounted = mounted_.at(mounting);
    if (!mounted) return std::nullopt;
    return (Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()) * *mounted).inverse();
  }

  renderer::Camera camera_in(const Eigen::Isometry3d& holder_from_world) const {
    return camera_of(calibration_.lens.lens, holder_from_world * calibration_.platform.world_from_camera, false);
  }

  void check_lamp(const Seen& seen) {
    const double angle_rad =
        seen.bench.angle ? seen.bench.angle->angle_rad : calibration_.platform.scale * seen.reading_rad;
    const auto holder_from_world = turned_holder(seen.step.mounting, angle_rad);
    if (!holder_from_world) return;
    for (const Finding& finding :
         lamp_.judge(seen.step, developer_of(seen.raw), camera_in(*holder_from_world), *holder_from_world))
      verdict_.findings.push_back(finding);
  }

  // The transform platform_from_holder from this run's pose pictures, and from those of an earlier run for a session
  // that goes on.
  std::optional<Eigen::Isometry3d> holder_of(rig::Mounting mounting) const {
    std::vector<PosePicture> pictures;
    if (const auto posed = posed_.find(mounting); posed != posed_.end()) pictures = posed->second;
    for (const auto& [id, record] : taken_pictures(session_.records())) {
      const auto same_step = [&step = id](const PosePicture& picture) { return picture.step == step; };
      if (record.kind != StepKind::pose || record.mounting != mounting || std::ranges::any_of(pictures, same_step))
        continue;
      const calibration::SensorPicture raw = calibration::read_sensor_file(session_.path() / record.file);
      pictures.push_back({id, record.read_angle_rad, tags_in(raw)});
    }
    const auto shown = [&](const PosePicture& picture) { return shows_holder(picture, asked_.rig.holder_tags); };
    if (pictures.empty() || !std::ranges::all_of(pictures, shown)) return std::nullopt;
    return measure_holder(pictures, calibration_, asked_.rig).platform_from_holder;
  }

  const SessionFolder& session_;
  const SessionFile& asked_;
  RigCalibration calibration_;
  bool in_order_;
  Verdict verdict_;
  TestPicture test_;                                                   // the last one
  std::string date_time_;                                              // of the picture before
  std::map<rig::Mounting, std::vector<PosePicture>> posed_;            // this run's
  std::map<rig::Mounting, std::optional<Eigen::Isometry3d>> mounted_;  // platform_from_holder
  std::map<std::pair<rig::Lamp, rig::Mounting>, std::vector<double>> sharpness_;
  std::map<std::string, std::optional<double>> edge_blurs_px_;  // of earlier views' pictures, by their hashes
  LampChecks lamp_;
};

CaptureChecks::CaptureChecks(const SessionFolder& session, const SessionFile& asked, const RigCalibration& calibration,
                             bool in_order)
    : work_(std::make_shared<Work>(session, asked, calibration, in_order)) {}

ExposureChoice CaptureChecks::choose_exposure(const PlanStep& step, const rig::Picture& test) {
  return work_->choose(step, test);
}

std::optional<double> CaptureChecks::read_lamp(const PlanStep& step, const rig::Picture& test) {
  return work_->read_lamp(step, test);
}

Verdict CaptureChecks::judge(const PlanStep& step, const rig::Picture& picture, double platform_reading_rad) {
  return work_->judge(step, picture, platform_reading_rad);
}

cv::Mat1b metered_region(const SessionFile& asked, const RigCalibration& calibration, const PlanStep& step) {
  const Eigen::Isometry3d world_from_object = Eigen::AngleAxisd(step.platform_angle_rad, Eigen::Vector3d::UnitZ()) *
                                              nominal_pose(asked.rig, asked.spool, step.mounting);
  const Eigen::Isometry3d object_from_world = world_from_object.inverse();
  const renderer::Camera camera =
      camera_of(calibration.lens.lens, object_from_world * calibration.platform.world_from_camera, false);
  if (asked.spool.fabric)
    return lit_side(asked.spool.fabric->cylinder, camera,
                    lamp_in_holder(calibration, asked.rig, step.lamp, object_from_world).position);
  const inversion::WrappedSpool& spool = asked.spool.wrapping;
  const double half_width = spool.window_width_mm / 2, half_height = spool.window_height_mm / 2;
  const std::array<Eigen::Vector3d, 4> corners{{{0, -half_width, -half_height},
                                                {0, half_width, -half_height},
                                                {0, half_width, half_height},
                                                {0, -half_width, half_height}}};
  std::array<Eigen::Vector2d, 4> corners_px;
  std::ranges::transform(corners, corners_px.begin(),
                         [&](const Eigen::Vector3d& corner) { return renderer::project(camera, corner); });
  return calibration::polygon_mask({camera.width, camera.height}, corners_px);
}

}  // namespace station
