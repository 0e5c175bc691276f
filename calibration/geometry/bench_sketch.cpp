#include "calibration/geometry/bench_sketch.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "calibration/geometry/correspondences.h"
#include "calibration/geometry/pose.h"
#include "calibration/sensor/degree.h"

namespace calibration {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr std::size_t kFewestTags = 3;
// Focal lengths that are tried, in widths of the picture: fields of view of 100 to 2 degrees.
constexpr double kShortest = 0.4, kLongest = 30;
constexpr int kFocalLengths = 30, kRefinements = 24;

std::vector<std::vector<Corner>> matched(const TagLayout& ring, const std::vector<RingSighting>& sightings) {
  std::vector<std::vector<Corner>> all;
  for (const RingSighting& sighting : sightings) {
    all.push_back(match_corners(ring, sighting.seen));
    if (all.back().size() < 4 * kFewestTags)
      throw std::runtime_error(
          "with the platform at " + std::to_string(std::lround(sighting.reading_rad / kDegree)) + " degrees " +
          std::to_string(all.back().size() / 4) + " of the " + std::to_string(ring.tags.size()) +
          " tags on the platform are seen, and at least " + std::to_string(kFewestTags) +
          " are needed; point the camera at the platform, focus on it, light it evenly and clear what covers the tags");
  }
  return all;
}

struct Poses {
  std::vector<Eigen::Isometry3d> ring_from_camera;
  double rms_px = 0;
};

Poses poses_for(double focal_length_px, cv::Size picture, const std::vector<std::vector<Corner>>& corners) {
  Poses poses;
  double squares = 0, count = 0;
  for (const std::vector<Corner>& seen : corners) {
    const auto fit = fit_pose(plain_lens(focal_length_px, picture.width, picture.height), seen);
    poses.ring_from_camera.push_back(fit->camera_from_object.inverse());
    squares += fit->rms_px * fit->rms_px * static_cast<double>(seen.size());
    count += static_cast<double>(seen.size());
  }
  poses.rms_px = std::sqrt(squares / count);
  return poses;
}

// The focal length whose poses fit best: a coarse search, then golden sections, both in its logarithm.
double best_focal_length_px(cv::Size picture, const std::vector<std::vector<Corner>>& corners) {
  const auto error = [&](double log_f) { return poses_for(std::exp(log_f), picture, corners).rms_px; };
  const double first = std::log(kShortest * picture.width), step = std::log(kLongest / kShortest) / (kFocalLengths - 1);
  int best = 0;
  double least = std::numeric_limits<double>::max();
  for (int i = 0; i < kFocalLengths; ++i)
    if (const double e = error(first + i * step); e < least) best = i, least = e;
  const double section = (std::sqrt(5.0) - 1) / 2;
  double low = first + (best - 1) * step, high = first + (best + 1) * step;
  double a = high - section * (high - low), b = low + section * (high - low), error_a = error(a), error_b = error(b);
  for (int i = 0; i < kRefinements; ++i) {
    if (error_a < error_b) {
      high = b, b = a, error_b = error_a;
      a = high - section * (high - low), error_a = error(a);
    } else {
      low = a, a = b, error_a = error_b;
      b = low + section * (high - low), error_b = error(b);
    }
  }
  return std::exp((low + high) / 2);
}

// The multiple of a turn that brings `angle` nearest to `wanted`, added to it.
double near(double angle, double wanted) {
  const double turn = 2 * std::numbers::pi;
  return angle + turn * std::round((wanted - angle) / turn);
}

}  // namespace

BenchSketch sketch_bench(const TagLayout& ring, cv::Size picture, const std::vector<RingSighting>& sightings) {
  if (sightings.size() < 2) throw std::runtime_error("a bench is sketched from at least two angles of its platform");
  const auto corners = matched(ring, sightings);
  BenchSketch sketch;
  sketch.focal_length_px = best_focal_length_px(picture, corners);
  const Poses poses = poses_for(sketch.focal_length_px, picture, corners);
  sketch.rms_px = poses.rms_px;
  const auto count = static_cast<double>(sightings.size());
  // Angles of the ring's first tag from the camera, counter-clockwise: true = first_tag + turned_per_reading * reading.
  Eigen::MatrixX2d readings(static_cast<Eigen::Index>(sightings.size()), 2);
  Eigen::VectorXd turned(readings.rows());
  for (Eigen::Index i = 0; i < readings.rows(); ++i) {
    const Eigen::Isometry3d& camera = poses.ring_from_camera[static_cast<std::size_t>(i)];
    const Vector3d place = camera.translation(), forward = camera.linear().col(2);
    const Vector3d towards = Vector3d(place.x(), place.y(), 0).normalized(), right(-towards.y(), towards.x(), 0);
    const double distance = place.head<2>().norm(), along = -distance / forward.dot(towards);
    sketch.camera_mm += Vector3d(distance, 0, place.z()) / count;
    sketch.aim_mm += Vector3d(0, along * forward.dot(right), place.z() + along * forward.z()) / count;
    sketch.roll_rad += std::asin(camera.linear()(2, 0)) / count;
    const double reading = sightings[static_cast<std::size_t>(i)].reading_rad,
                 angle = -std::atan2(place.y(), place.x());
    readings.row(i) << 1, reading;
    // What earlier readings say decides how many whole turns there are between two of them.
    double expected = angle;
    if (i == 1) expected = turned[0] + reading - readings(0, 1);
    if (i > 1) {
      const Vector2d line = readings.topRows(i).colPivHouseholderQr().solve(turned.head(i));
      expected = line[0] + line[1] * reading;
    }
    turned[i] = near(angle, expected);
  }
  const Vector2d line = readings.colPivHouseholderQr().solve(turned);
  sketch.first_tag_rad = near(line[0], 0);
  sketch.turned_per_reading = line[1];
  return sketch;
}

}  // namespace calibration
