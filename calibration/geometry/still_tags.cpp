#include "calibration/geometry/still_tags.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calibration/sensor/median.h"

namespace calibration {
namespace {

// Of a tag's shape, over its shift, and more than noise: above them the tag has not moved, but something lies over part
// of it.
constexpr double kMostChange = 0.5, kNoise_px = 0.3;

Eigen::Vector2d middle_of(const std::vector<Eigen::Vector2d>& points) {
  std::vector<double> x, y;
  for (const Eigen::Vector2d& point : points) {
    x.push_back(point.x());
    y.push_back(point.y());
  }
  return {median(x), median(y)};
}

// By how much a tag's corners, px (root mean square), are not where a rigid motion in its plane would have taken them:
// a shadow that falls over its side moves the corners there alone.
double change_of_shape_px(const std::array<Eigen::Vector2d, 4>& before, const std::array<Eigen::Vector2d, 4>& now) {
  // Coordinates in which the tag is a square.
  Eigen::Matrix2d pixels;
  pixels.col(0) = (before[1] + before[2] - before[0] - before[3]) / 2;
  pixels.col(1) = (before[2] + before[3] - before[0] - before[1]) / 2;
  if (!(std::abs(pixels.determinant()) > 0)) return 0;
  const Eigen::Matrix2d square = pixels.inverse();
  Eigen::Matrix<double, 2, 4> from, to;
  for (int c = 0; c < 4; ++c) {
    from.col(c) = square * before[static_cast<std::size_t>(c)];
    to.col(c) = square * now[static_cast<std::size_t>(c)];
  }
  from.colwise() -= from.rowwise().mean().eval();
  to.colwise() -= to.rowwise().mean().eval();
  const Eigen::Matrix2d product = to * from.transpose();
  const double turned = std::atan2(product(1, 0) - product(0, 1), product.trace());
  return (pixels * (to - Eigen::Rotation2Dd(turned).toRotationMatrix() * from)).norm() / 2;
}

}  // namespace

StillTags still_tags(const TagLayout& layout, const std::vector<TagObservation>& pictures) {
  StillTags still;
  for (const Tag& tag : layout.tags) {
    std::array<std::vector<Eigen::Vector2d>, 4> seen;
    for (const TagObservation& picture : pictures) {
      for (const TagDetection& detection : picture) {
        if (detection.id != tag.id) continue;
        for (std::size_t c = 0; c < 4; ++c) seen[c].push_back(detection.corners_px[c]);
      }
    }
    if (seen[0].empty()) continue;
    for (std::size_t c = 0; c < 4; ++c) still[tag.id][c] = middle_of(seen[c]);
  }
  return still;
}

std::optional<Shift> shift_of(const StillTags& reference, const TagObservation& seen) {
  std::vector<int> ids;
  std::vector<Eigen::Vector2d> shifts;
  std::vector<double> changes_px;
  for (const TagDetection& detection : seen) {
    const auto known = reference.find(detection.id);
    if (known == reference.end()) continue;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (std::size_t c = 0; c < 4; ++c) mean += 0.25 * (detection.corners_px[c] - known->second[c]);
    ids.push_back(detection.id);
    shifts.push_back(mean);
    changes_px.push_back(change_of_shape_px(known->second, detection.corners_px));
  }
  if (shifts.size() < 2) return std::nullopt;
  Shift shift{.mean_px = middle_of(shifts), .tags = static_cast<int>(shifts.size())};
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    const double own_px = (shifts[i] - shift.mean_px).norm();
    if (own_px <= shift.odd_px || changes_px[i] > std::max(kMostChange * own_px, kNoise_px)) continue;
    shift.odd_px = own_px;
    shift.odd_id = ids[i];
  }
  return shift;
}

std::optional<std::string> shift_problem(const Shift& shift, double limit_px, const std::string& picture) {
  char text[300];
  if (shift.mean_px.norm() > limit_px)
    std::snprintf(text, sizeof text,
                  "%s: the table's tags stand %.2f px from where they were (limit %.2f): the camera or the table was "
                  "bumped; fasten it and calibrate the platform again",
                  picture.c_str(), shift.mean_px.norm(), limit_px);
  else if (shift.odd_px > limit_px)
    std::snprintf(text, sizeof text,
                  "%s: tag %d on the table moved by %.2f px against the others (limit %.2f); fasten it and calibrate "
                  "the platform again",
                  picture.c_str(), shift.odd_id, shift.odd_px, limit_px);
  else
    return std::nullopt;
  return text;
}

}  // namespace calibration
