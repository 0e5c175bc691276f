#include "station/session/checks/lamp_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>  // boundingRect

#include "calibration/develop/polygon_mask.h"
#include "calibration/light/lamp_stability.h"
#include "calibration/sensor/median.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/reference_chip.h"
#include "station/documents/number_text.h"

namespace station {
namespace {

constexpr double kLampOff = 0.5;  // part of the calibrated strength
// The limit between front and back light: light on the holder's tags as a part of what the lamp in front gives a white
// surface there. Their paper shows 0.1 to 0.9 under that lamp, and only what the bench throws back under the one
// behind.
constexpr double kLitFromTheFront = 0.04;
constexpr int kTagPercentile = 80;  // of the pixels of a tag: its paper, not its ink
constexpr std::size_t kFewestPixels = 16;

struct TagLight {
  double radiance = 0;
  bool saturated = false;  // the light is at least `radiance`
};

// The box that a quadrangle covers in the picture, and a pixel around it.
cv::Rect box_of(const std::array<Eigen::Vector2d, 4>& corners_px, const renderer::Camera& camera) {
  std::vector<cv::Point2f> outline;
  for (const Eigen::Vector2d& corner : corners_px)
    outline.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  const cv::Rect covered = cv::boundingRect(outline);
  return cv::Rect(covered.tl() - cv::Point(1, 1), covered.br() + cv::Point(1, 1)) &
         cv::Rect(0, 0, camera.width, camera.height);
}

std::optional<TagLight> tag_light(const DevelopPart& develop, const renderer::Camera& camera,
                                  std::array<Eigen::Vector2d, 4> corners_px) {
  const cv::Rect box = box_of(corners_px, camera);
  if (box.empty()) return std::nullopt;
  const calibration::Developed developed = develop(box);
  for (Eigen::Vector2d& corner : corners_px) corner -= Eigen::Vector2d(box.x, box.y);
  const cv::Mat1b inside = calibration::polygon_mask(box.size(), corners_px);
  std::vector<TagLight> pixels;
  for (int row = 0; row < box.height; ++row)
    for (int column = 0; column < box.width; ++column)
      if (inside(row, column) != 0) {
        const cv::Vec3f& pixel = developed.radiance(row, column);
        pixels.push_back({(pixel[0] + pixel[1] + pixel[2]) / 3.0, developed.saturated(row, column) != 0});
      }
  if (pixels.size() < kFewestPixels) return std::nullopt;
  const auto at = pixels.begin() + static_cast<std::ptrdiff_t>(pixels.size() * kTagPercentile / 100);
  std::ranges::nth_element(pixels, at, {}, &TagLight::radiance);
  return *at;
}

}  // namespace

LampChecks::LampChecks(const SessionFile& asked, const RigCalibration& calibration)
    : asked_(asked), calibration_(calibration) {}

std::vector<Finding> LampChecks::judge(const PlanStep& step, const DevelopPart& develop, const renderer::Camera& camera,
                                       const Eigen::Isometry3d& holder_from_world) {
  if (asked_.spool.fabric) return {};  // nothing on the cylinder says anything of the lamp
  const std::optional<Finding> on_side = side(step, develop, camera, holder_from_world);
  const std::optional<double> part = strength(step, develop, camera, holder_from_world);
  // The strength is that of the calibrated lamp, so it counts only with the lamp on the right side or off.
  const bool wrong_side = on_side && on_side->grade == Grade::bad && (!part || *part >= kLampOff);
  std::vector<Finding> findings;
  if (part && !wrong_side) {
    const std::string reason = problem(step, *part);
    findings.push_back(
        {.check = "lamp", .grade = reason.empty() ? Grade::good : Grade::bad, .value = 100 * *part, .reason = reason});
    if (reason.empty()) last_ = LastView{step.lamp, step.mounting, *part};
  }
  if (on_side) findings.push_back(*on_side);
  return findings;
}

std::optional<double> LampChecks::read(const PlanStep& step, const DevelopPart& develop, const renderer::Camera& camera,
                                       const Eigen::Isometry3d& holder_from_world) const {
  if (asked_.spool.fabric) return std::nullopt;
  const std::optional<double> part = strength(step, develop, camera, holder_from_world);
  return part && *part >= kLampOff ? part : std::nullopt;
}

inversion::NearLight LampChecks::lamp(rig::Lamp side, const Eigen::Isometry3d& holder_from_world) const {
  return lamp_in_holder(calibration_, asked_.rig, side, holder_from_world);
}

// The light at the reference chip, measured / expected; nothing where it cannot be read.
std::optional<double> LampChecks::strength(const PlanStep& step, const DevelopPart& develop,
                                           const renderer::Camera& camera,
                                           const Eigen::Isometry3d& holder_from_world) const {
  if (!asked_.rig.reference_chip) return std::nullopt;
  const cv::Rect box =
      box_of(chip_outline(camera, *asked_.rig.reference_chip, asked_.spool.wrapping, step.mounting), camera);
  if (box.empty()) return std::nullopt;
  const calibration::Developed developed = develop(box);
  const auto reading =
      read_chip(developed.radiance, developed.saturated, renderer::cut(camera, box.x, box.y, box.width, box.height),
                *asked_.rig.reference_chip, asked_.spool.wrapping, step.mounting, lamp(step.lamp, holder_from_world),
                calibration_.light.droop);
  return reading ? std::optional(reading->strength) : std::nullopt;
}

std::string LampChecks::problem(const PlanStep& step, double strength) const {
  const calibration::LampGates limits;
  const std::string found_there =
      "'" + step.id + "': the reference chip shows " + percent_text(strength) + " of the calibrated lamp";
  if (strength < kLampOff) return found_there + "; switch the lamp on and see that nothing covers it, then resume";
  if (strength > 1 + limits.largest_change)
    return found_there + "; switch the room light off and see that only the lamp shines, then resume";
  if (strength < 1 - limits.largest_change) return found_there + "; cool or replace the lamp and calibrate again";
  const bool comparable = last_ && last_->lamp == step.lamp && last_->mounting == step.mounting;
  if (comparable && std::abs(strength / last_->strength - 1) > limits.largest_jump)
    return found_there + ", " + percent_text(last_->strength) + " in the view before; let the lamp settle, then resume";
  return {};
}

// The holder's tags are on its front: bright under the lamp in front, dark under the one behind.
std::optional<Finding> LampChecks::side(const PlanStep& step, const DevelopPart& develop,
                                        const renderer::Camera& camera,
                                        const Eigen::Isometry3d& holder_from_world) const {
  const inversion::NearLight front = lamp(rig::Lamp::front, holder_from_world);
  std::vector<double> parts;
  std::size_t saturated = 0;
  for (const calibration::Tag& tag : asked_.rig.holder_tags.tags) {
    const Eigen::Vector3d centre = tag.object_from_tag.translation();
    const Eigen::Vector3d to_lamp = front.position - centre, to_eye = camera.world_from_camera.translation() - centre;
    const Eigen::Vector3d normal = tag.object_from_tag.linear().col(2);
    const double cosine = normal.dot(to_lamp.normalized());
    if (cosine < 0.2 || normal.dot(to_eye) <= 0) continue;
    const std::array<Eigen::Vector3d, 4> corners = calibration::corners_in_object(tag);
    std::array<Eigen::Vector2d, 4> corners_px;
    std::ranges::transform(corners, corners_px.begin(),
                           [&](const Eigen::Vector3d& corner) { return renderer::project(camera, corner); });
    const double white = front.intensity.mean() * cosine / to_lamp.squaredNorm() / std::numbers::pi;
    if (const auto light = tag_light(develop, camera, corners_px)) {
      parts.push_back(light->radiance / white);
      saturated += light->saturated;
    }
  }
  if (parts.empty()) return std::nullopt;
  const double part = calibration::median(parts);
  const bool from_front = part > kLitFromTheFront, wanted = step.lamp != rig::Lamp::back;
  if (!from_front && saturated > 0) return std::nullopt;
  Finding finding{.check = "lamp_side", .grade = Grade::good, .value = 100 * part, .reason = {}};
  if (from_front != wanted) {
    finding.grade = Grade::bad;
    finding.reason = "'" + step.id + "' was to be lit from " + (wanted ? "the front" : "behind") +
                     " and the holder's front is " + (from_front ? "lit" : "dark") + "; put the lamp " +
                     (wanted ? "in front of" : "behind") + " the platform, then resume";
  }
  return finding;
}

}  // namespace station
