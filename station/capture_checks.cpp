#include "station/capture_checks.h"

#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

#include "calibration/develop.h"
#include "calibration/lamp_stability.h"
#include "calibration/pose.h"
#include "calibration/sensor_maps.h"
#include "station/capture/picture_record.h"
#include "station/exposure.h"
#include "station/reference_patch.h"
#include "station/report/html.h"
#include "station/views.h"

namespace station {
namespace {

constexpr double kOverExposed = 0.97, kOverExposedPercentile = 95, kUnderExposed = 0.02;
constexpr double kMostDarkOffset = 1e-3;  // of the range
constexpr int kFewestTags = 2;

std::string percent(double part) {
  return number_text(100 * part, 1) + " %";
}

struct Mounted {
  Eigen::Isometry3d world_from_holder;
  double reading_rad;
};

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
    if (step.kind == StepKind::pose) mounted_[step.mounting] = holder_in(raw, reading_rad);
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
    if (!mounted_.contains(step.mounting)) mounted_[step.mounting] = stored_pose(step.mounting);
    const std::optional<Mounted>& mounted = mounted_.at(step.mounting);
    if (!mounted) return std::nullopt;
    const double turned_rad = calibration_.platform.scale * (reading_rad - mounted->reading_rad);
    const Eigen::Isometry3d holder_from_world =
        (Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitZ()) * mounted->world_from_holder).inverse();
    calibration::DevelopOptions options{.vignetting = calibration_.light.vignetting};
    if (calibration_.sensor) options.response = &calibration_.sensor->response;
    const calibration::Developed picture = calibration::develop(raw, options);
    const renderer::Camera camera =
        camera_of(calibration_.lens.lens, holder_from_world * calibration_.platform.world_from_camera, false);
    return read_patch(
        picture.radiance, picture.saturated, camera, *asked_.rig.reference_patch, asked_.spool.wrapping,
        step.mounting,
        lamp_in_holder(calibration_, asked_.rig.lamp_radius_mm, step.lamp == rig::Lamp::back, holder_from_world));
  }

  std::optional<Mounted> holder_in(const calibration::SensorPicture& raw, double reading_rad) const {
    const auto pose = calibration::fit_pose(calibration_.lens.lens, asked_.rig.holder_tags, tags_in(raw));
    if (!pose || pose->tags_used < kFewestTags) return std::nullopt;
    return Mounted{calibration_.platform.world_from_camera * pose->camera_from_object, reading_rad};
  }

  // Of a session that goes on: from the picture that an earlier run took.
  std::optional<Mounted> stored_pose(rig::Mounting mounting) const {
    for (const auto& [id, record] : taken_pictures(session_.records()))
      if (record.kind == StepKind::pose && record.mounting == mounting)
        return holder_in(calibration::read_sensor_file(session_.path() / record.file), record.read_angle_rad);
    return std::nullopt;
  }

  const SessionFolder& session_;
  const SessionFile& asked_;
  RigCalibration calibration_;
  std::map<rig::Mounting, std::optional<Mounted>> mounted_;
  std::optional<LastView> last_;  // of this run
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
