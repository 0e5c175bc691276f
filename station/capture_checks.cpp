#include "station/capture_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

#include "calibration/develop.h"
#include "calibration/lamp_stability.h"
#include "calibration/sensor_maps.h"
#include "station/bench_reading.h"
#include "station/capture/picture_record.h"
#include "station/develop/mounted_holder.h"
#include "station/exposure.h"
#include "station/reference_patch.h"
#include "station/report/html.h"
#include "station/views.h"

namespace station {
namespace {

constexpr double kOverExposed = 0.97, kOverExposedPercentile = 95, kUnderExposed = 0.02;
constexpr double kMostDarkOffset = 1e-3;  // of the range

std::string percent(double part) {
  return number_text(100 * part, 1) + " %";
}

struct LastView {
  rig::Lamp lamp;
  rig::Mounting mounting;
  double strength;
};

class Inspection {
 public:
  Inspection(const SessionFolder& session, const SessionFile& asked, const RigCalibration& calibration)
      : session_(session), asked_(asked), calibration_(calibration) {
    if (calibration_.sensor) load_sensor_maps(session.path() / "calibration", *calibration_.sensor);
  }

  void operator()(const PlanStep& step, const rig::Picture& picture, double reading_rad) {
    if (step.kind == StepKind::exposure) return;  // its view has been looked at
    const calibration::SensorPicture raw = calibration::read_sensor_bytes(picture.bytes, "picture of " + step.id);
    if (step.kind == StepKind::pose) posed_[step.mounting].push_back({step.id, reading_rad, tags_in(raw)});
    if (step.kind == StepKind::dark && calibration_.sensor) check_dark(step, raw);
    if (step.kind == StepKind::view) check_view(step, raw, reading_rad);
  }

 private:
  void check_dark(const PlanStep& step, const calibration::SensorPicture& raw) const {
    const double offset = calibration::dark_offset_dn(raw, calibration_.sensor->response.maps) /
                          (raw.white_level_dn - raw.black_level_dn);
    if (offset > kMostDarkOffset)
      throw std::runtime_error(
          "'" + step.id + "' was to be dark and is " + number_text(100 * offset, 2) +
          " % of the range brighter than the calibration's dark frames; switch the room light and "
          "the lamp off, close the curtain, then resume");
  }

  void check_view(const PlanStep& step, const calibration::SensorPicture& raw, double reading_rad) {
    const cv::Mat1b window =
        window_region(asked_.rig, asked_.spool.wrapping, calibration_, step.mounting, step.platform_angle_rad);
    if (bright_level(raw, window, kOverExposedPercentile) > kOverExposed)
      throw std::runtime_error(
          "'" + step.id + "' is over-exposed at " + number_text(raw.exposure_s, 5) +
          " s: more than 5 % of the threads' window is saturated; move the lamp away, then resume");
    const std::optional<PatchReading> reading = patch_reading(step, raw, reading_rad);
    if (reading) check_lamp(step, reading->strength);
    const double level = bright_level(raw, window, ExposureAim{}.percentile);
    if (level < kUnderExposed)
      throw std::runtime_error("'" + step.id + "' is dark: the brightest threads reach " + percent(level) +
                               " of the range at " + number_text(raw.exposure_s, 3) +
                               " s; see that the lamp is on and shines on the threads, then resume");
  }

  void check_lamp(const PlanStep& step, double strength) {
    const calibration::LampGates limits;
    const std::string found =
        "'" + step.id + "': the reference patch shows " + percent(strength) + " of the calibrated lamp";
    if (strength < 0.5)
      throw std::runtime_error(found + "; switch the lamp on and see that nothing covers it, then resume");
    if (strength > 1 + limits.largest_change)
      throw std::runtime_error(found + "; switch the room light off and see that only the lamp shines, then resume");
    if (strength < 1 - limits.largest_change)
      throw std::runtime_error(found + "; cool or replace the lamp and calibrate again");
    const bool comparable = last_ && last_->lamp == step.lamp && last_->mounting == step.mounting;
    if (comparable && std::abs(strength / last_->strength - 1) > limits.largest_jump)
      throw std::runtime_error(found + ", " + percent(last_->strength) +
                               " in the view before; let the lamp settle, then resume");
    last_ = LastView{step.lamp, step.mounting, strength};
  }

  std::optional<PatchReading> patch_reading(const PlanStep& step, const calibration::SensorPicture& raw,
                                            double reading_rad) {
    if (!asked_.rig.reference_patch) return std::nullopt;
    if (!mounted_.contains(step.mounting)) mounted_[step.mounting] = holder_of(step.mounting);
    const std::optional<Eigen::Isometry3d>& mounted = mounted_.at(step.mounting);
    if (!mounted) return std::nullopt;
    const BenchReading bench = read_bench(calibration_, asked_.rig, tags_in(raw));
    const double angle_rad = bench.angle ? bench.angle->angle_rad : calibration_.platform.scale * reading_rad;
    const Eigen::Isometry3d holder_from_world =
        (Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()) * *mounted).inverse();
    calibration::DevelopOptions options{.vignetting = calibration_.light.vignetting};
    if (calibration_.sensor) options.response = &calibration_.sensor->response;
    const calibration::Developed picture = calibration::develop(raw, options);
    const renderer::Camera camera =
        camera_of(calibration_.lens.lens, holder_from_world * calibration_.platform.world_from_camera, false);
    return read_patch(
        picture.radiance, picture.saturated, camera, *asked_.rig.reference_patch, asked_.spool.wrapping,
        step.mounting,
        lamp_in_holder(calibration_, asked_.rig.lamp_radius_mm, step.lamp == rig::Lamp::back, holder_from_world),
        calibration_.light.droop);
  }

  // From this run's pose pictures; a session that goes on has those of an earlier run.
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
  std::map<rig::Mounting, std::vector<PosePicture>> posed_;            // this run's
  std::map<rig::Mounting, std::optional<Eigen::Isometry3d>> mounted_;  // platform_from_holder
  std::optional<LastView> last_;                                       // of this run
};

}  // namespace

InspectPicture make_inspection(const SessionFolder& session, const SessionFile& asked,
                               const RigCalibration& calibration) {
  const auto inspection = std::make_shared<Inspection>(session, asked, calibration);
  return [inspection](const PlanStep& step, const rig::Picture& picture, double reading_rad) {
    (*inspection)(step, picture, reading_rad);
  };
}

Eigen::Isometry3d nominal_holder_pose(const RigFile& rig, const inversion::WrappedSpool& spool,
                                      rig::Mounting mounting) {
  const bool vertical = mounting == rig::Mounting::vertical;
  const double half_height_mm = (vertical ? spool.frame_width_mm : spool.frame_height_mm) / 2;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = rig.platform_height_mm + half_height_mm;
  if (vertical) pose.rotate(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
  return pose;
}

cv::Mat1b window_region(const RigFile& rig, const inversion::WrappedSpool& spool, const RigCalibration& calibration,
                        rig::Mounting mounting, double platform_angle_rad) {
  const Eigen::Isometry3d world_from_holder =
      Eigen::AngleAxisd(platform_angle_rad, Eigen::Vector3d::UnitZ()) * nominal_holder_pose(rig, spool, mounting);
  const renderer::Camera camera =
      camera_of(calibration.lens.lens, world_from_holder.inverse() * calibration.platform.world_from_camera, false);
  cv::Mat1b region(camera.height, camera.width, static_cast<unsigned char>(0));
  std::vector<cv::Point> outline;
  for (const auto& [y, z] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    const Eigen::Vector2d pixel =
        renderer::project(camera, {0, y * spool.window_width_mm, z * spool.window_height_mm});
    outline.emplace_back(cvRound(pixel.x()), cvRound(pixel.y()));
  }
  cv::fillConvexPoly(region, outline, cv::Scalar(255));
  return region;
}

}  // namespace station
