#include "station/bench/reference_chip.h"

#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "calibration/light/light.h"

namespace station {
namespace {

constexpr double kUsedOfChip = 0.7;       // of the chip's edge: away from its border, which blurs into the frame
constexpr double kBesideThreads_mm = 20;  // the upright edge carries the threads' turns in its middle
constexpr int kFewestPixels = 30;

// The factor of the place that views[first] is the first to be lit from. The mean of its series is taken to stand on
// the straight line in time between the views before and after it, under the lamp's other place; without one after it,
// its first to be as the one before.
double reading_at_strength_one(const std::vector<ChipView>& views, std::size_t first, double before, double before_s,
                               double other_at_strength_one) {
  double sum = 0, sum_s = 0;
  int count = 0;
  std::size_t i = first;
  for (; i < views.size() && views[i].behind == views[first].behind; ++i) {
    if (!views[i].reading) continue;
    sum += views[i].reading->strength;
    sum_s += views[i].time_s;
    ++count;
  }
  while (i < views.size() && !views[i].reading) ++i;
  if (other_at_strength_one == 0 || i == views.size() || !(views[i].time_s > before_s))
    return views[first].reading->strength / before;
  const double after = views[i].reading->strength / other_at_strength_one;
  const double part = (sum_s / count - before_s) / (views[i].time_s - before_s);
  return sum / count / (before + part * (after - before));
}

}  // namespace

Eigen::Isometry3d holder_from_chip(const ReferenceChip& chip, const inversion::WrappedSpool& spool,
                                   rig::Mounting mounting) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const double back = -chip.edge_mm / 2;
  if (mounting == rig::Mounting::horizontal) {
    pose.translation() = Eigen::Vector3d(back, 0, spool.frame_height_mm / 2);
  } else {
    pose.linear() =
        Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();  // +z becomes +y
    pose.translation() = Eigen::Vector3d(back, spool.frame_width_mm / 2, kBesideThreads_mm);
  }
  return pose;
}

std::array<Eigen::Vector2d, 4> chip_outline(const renderer::Camera& camera, const ReferenceChip& chip,
                                            const inversion::WrappedSpool& spool, rig::Mounting mounting) {
  const Eigen::Isometry3d pose = holder_from_chip(chip, spool, mounting);
  const double half = kUsedOfChip * chip.edge_mm / 2;
  std::array<Eigen::Vector2d, 4> outline{{{-half, -half}, {half, -half}, {half, half}, {-half, half}}};
  for (Eigen::Vector2d& corner : outline)
    corner = renderer::project(camera, pose * Eigen::Vector3d(corner.x(), corner.y(), 0));
  return outline;
}

std::optional<ChipReading> read_chip(const cv::Mat3f& radiance, const cv::Mat1b& saturated,
                                     const renderer::Camera& camera, const ReferenceChip& chip,
                                     const inversion::WrappedSpool& spool, rig::Mounting mounting,
                                     const inversion::NearLight& light, const Eigen::Vector2d& droop) {
  const Eigen::Isometry3d pose = holder_from_chip(chip, spool, mounting);
  std::vector<cv::Point2f> outline;
  const cv::Rect frame(0, 0, radiance.cols, radiance.rows);
  for (const Eigen::Vector2d& pixel : chip_outline(camera, chip, spool, mounting)) {
    outline.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    if (!frame.contains(cv::Point(cvRound(pixel.x()), cvRound(pixel.y())))) return std::nullopt;
  }
  const Eigen::Vector3d offset = light.position - pose.translation(), to_light = offset.normalized(),
                        normal = pose.linear().col(2);
  const Eigen::Vector3d to_camera = (camera.world_from_camera.translation() - pose.translation()).normalized();
  const double cosine = to_light.dot(normal);
  if (!(cosine > 0.1)) return std::nullopt;
  const double along_beam = std::max(0.0, -to_light.dot(light.beam_axis));
  const double beam = light.beam_exponent == 0.0 ? 1.0 : std::pow(along_beam, light.beam_exponent);
  const double expected = chip.albedo / std::numbers::pi * light.intensity.sum() * beam * cosine /
                          offset.squaredNorm() * calibration::panel_factor(droop, normal, to_light, to_camera);
  const cv::Rect box = cv::boundingRect(outline) & frame;
  double sum = 0, squares = 0;
  int count = 0;
  for (int row = box.y; row < box.y + box.height; ++row)
    for (int column = box.x; column < box.x + box.width; ++column) {
      const cv::Point2f here(static_cast<float>(column), static_cast<float>(row));
      if (cv::pointPolygonTest(outline, here, false) < 0) continue;
      if (saturated(row, column)) return std::nullopt;
      const cv::Vec3f& pixel = radiance(row, column);
      const double value =
          static_cast<double>(pixel[0]) + static_cast<double>(pixel[1]) + static_cast<double>(pixel[2]);
      sum += value;
      squares += value * value;
      ++count;
    }
  if (count < kFewestPixels) return std::nullopt;
  const double mean = sum / count;
  return ChipReading{.strength = mean / expected,
                     .sigma = std::sqrt(std::max(0.0, squares / count - mean * mean) / count) / expected};
}

std::vector<double> lamp_strengths(const std::vector<ChipView>& views) {
  std::array<double, 2> at_strength_one{};  // readings in front and behind; 0: none yet
  std::vector<double> strengths;
  double last = 1, last_s = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const ChipView& view = views[i];
    if (view.reading) {
      double& one = at_strength_one.at(view.behind ? 1 : 0);
      if (one == 0) one = reading_at_strength_one(views, i, last, last_s, at_strength_one.at(view.behind ? 0 : 1));
      last = view.reading->strength / one;
      last_s = view.time_s;
    }
    strengths.push_back(last);
  }
  return strengths;
}

}  // namespace station
