#include "station/bench/picture_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "calibration/sensor/median.h"
#include "calibration/sensor/sensor_range.h"

namespace station {
namespace {

constexpr double kSmallestTag_px = 16;
constexpr int kMostCompared = 1 << 20;  // pixels
constexpr double kReach_px = 4, kSampleEvery_px = 0.25;

float sample(const cv::Mat1f& picture, const Eigen::Vector2d& at) {
  const int column = static_cast<int>(std::floor(at.x())), row = static_cast<int>(std::floor(at.y()));
  if (column < 0 || row < 0 || column + 1 >= picture.cols || row + 1 >= picture.rows) return 0;
  const auto u = static_cast<float>(at.x() - column), v = static_cast<float>(at.y() - row);
  return (1 - v) * ((1 - u) * picture(row, column) + u * picture(row, column + 1)) +
         v * ((1 - u) * picture(row + 1, column) + u * picture(row + 1, column + 1));
}

// The width of a blurred edge: for a step blurred by a Gaussian, contrast / (steepest slope x sqrt(2 pi)). It includes
// the blur of the bilinear sampling.
std::optional<double> blur_across(const cv::Mat1f& picture, const Eigen::Vector2d& at, const Eigen::Vector2d& outwards,
                                  double reach_px) {
  double darkest = sample(picture, at), brightest = darkest, steepest = 0;
  for (double t = -reach_px; t < reach_px; t += kSampleEvery_px) {
    const double inner = sample(picture, at + t * outwards), outer = sample(picture, at + (t + 1) * outwards);
    darkest = std::min(darkest, inner), brightest = std::max(brightest, inner);
    steepest = std::max(steepest, outer - inner);
  }
  if (!(steepest > 0) || brightest < 2 * darkest) return std::nullopt;
  return (brightest - darkest) / (steepest * std::sqrt(2 * std::numbers::pi));
}

}  // namespace

double sharpness(const cv::Mat1f& linear_grey, const cv::Mat1b& region) {
  const cv::Rect box = cv::boundingRect(region);
  if (box.empty()) return 0;
  const cv::Mat1f part = linear_grey(box);
  cv::Mat1f fine, coarse;
  cv::GaussianBlur(part, fine, {0, 0}, 0.8);
  cv::GaussianBlur(part, coarse, {0, 0}, 1.6);
  // In large pictures every few pixels are enough: medians of a million say as much.
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(part.total()) / kMostCompared)));
  std::vector<float> details, lights;
  for (int row = 0; row < part.rows; row += step)
    for (int column = 0; column < part.cols; column += step) {
      if (region(box.y + row, box.x + column) == 0) continue;
      details.push_back(std::abs(fine(row, column) - coarse(row, column)));
      lights.push_back(coarse(row, column));
    }
  if (lights.empty()) return 0;
  const double light = calibration::median(std::move(lights));
  return light > 0 ? calibration::median(std::move(details)) / light : 0;
}

std::optional<double> edge_blur_px(const cv::Mat1f& linear_grey, const calibration::TagObservation& tags) {
  std::vector<double> blurs;
  for (const calibration::TagDetection& tag : tags) {
    const Eigen::Vector2d middle = (tag.corners_px[0] + tag.corners_px[1] + tag.corners_px[2] + tag.corners_px[3]) / 4;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d from = tag.corners_px[i], along = tag.corners_px[(i + 1) % 4] - from;
      if (along.norm() < kSmallestTag_px) continue;
      const double reach_px = std::min(kReach_px, along.norm() / 8);  // a cell: beyond it the next edge begins
      Eigen::Vector2d outwards(along.y(), -along.x());
      outwards.normalize();
      if (outwards.dot(from - middle) < 0) outwards = -outwards;
      for (const double part : {0.2, 0.35, 0.5, 0.65, 0.8})
        if (const auto blur = blur_across(linear_grey, from + part * along, outwards, reach_px)) blurs.push_back(*blur);
    }
  }
  if (blurs.empty()) return std::nullopt;
  return calibration::median(blurs);
}

std::optional<double> motion_px(const calibration::TagObservation& before, const calibration::TagObservation& after) {
  std::vector<double> moved;
  for (const calibration::TagDetection& tag : before)
    for (const calibration::TagDetection& same : after) {
      if (tag.id != same.id) continue;
      for (std::size_t i = 0; i < 4; ++i) moved.push_back((tag.corners_px[i] - same.corners_px[i]).norm());
    }
  if (moved.size() < 8) return std::nullopt;
  return calibration::median(moved);
}

double saturated_fraction(const calibration::SensorPicture& picture, const cv::Mat1b& region) {
  const double limit_dn = calibration::dn_at(picture, calibration::kSaturated);
  const cv::Rect box = cv::boundingRect(region);
  int inside = 0, saturated = 0;
  for (int row = box.y; row < box.br().y; ++row)
    for (int column = box.x; column < box.br().x; ++column) {
      if (region(row, column) == 0) continue;
      ++inside;
      saturated += picture.mosaic(row, column) > limit_dn;
    }
  return inside > 0 ? static_cast<double>(saturated) / inside : 0;
}

}  // namespace station
