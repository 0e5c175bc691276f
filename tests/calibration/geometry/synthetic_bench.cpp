#include "tests/calibration/geometry/synthetic_bench.h"

#include <cmath>
#include <numbers>

#include "calibration/sensor/degree.h"
#include "tests/calibration/geometry/synthetic_views.h"

namespace calibration::synthetic {
namespace {

Eigen::Isometry3d at(const Eigen::Vector3d& place, double turn_rad = 0.0) {
  Eigen::Isometry3d pose(Eigen::Translation3d{place});
  pose.rotate(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()));
  return pose;
}

TagLayout ring_of_tags() {
  TagLayout ring{.name = "ring", .tags = {}};
  for (int i = 0; i < 12; ++i) {
    const double angle = i * 30 * kDegree;
    ring.tags.push_back(
        {.id = 300 + i,
         .size_mm = 12,
         .object_from_tag = at({56 * std::cos(angle), 56 * std::sin(angle), 0}, angle + std::numbers::pi / 2)});
  }
  return ring;
}

TagLayout tags_on_table() {
  TagLayout sheet{.name = "table", .tags = {}};
  const double places[6][2] = {{45, -84}, {45, 84}, {-20, -92}, {-20, 92}, {-95, -70}, {-95, 70}};
  for (int i = 0; i < 6; ++i)
    sheet.tags.push_back({.id = 400 + i, .size_mm = 14, .object_from_tag = at({places[i][0], places[i][1], 0})});
  return sheet;
}

TagLayout tags_on_holder() {
  TagLayout holder{.name = "holder", .tags = {}};
  for (int i = 0; i < 4; ++i) {
    Tag tag{.id = 100 + i, .size_mm = 12};
    tag.object_from_tag.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // faces +x
    tag.object_from_tag.translation() = Eigen::Vector3d(0, i % 2 ? 26 : -26, i < 2 ? 26 : -26);
    holder.tags.push_back(tag);
  }
  return holder;
}

// True where the standing holder (half width 34 mm, top at 98 mm) is between the camera and a tag.
bool behind_holder(const Bench& bench, const Eigen::Isometry3d& world_from_holder, const Eigen::Vector3d& point) {
  const Eigen::Isometry3d holder_from_world = world_from_holder.inverse();
  const Eigen::Vector3d eye = holder_from_world * bench.world_from_camera.translation(), to = holder_from_world * point;
  if (eye.x() * to.x() >= 0.0) return false;
  const Eigen::Vector3d crossing = eye + (to - eye) * (eye.x() / (eye.x() - to.x()));
  return std::abs(crossing.y()) < 34.0 && std::abs(crossing.z()) < 34.0;
}

void add(TagObservation& seen, const TagObservation& more) {
  seen.insert(seen.end(), more.begin(), more.end());
}

TagLayout visible(const Bench& bench, const TagLayout& layout, const Eigen::Isometry3d& world_from_layout,
                  const Eigen::Isometry3d& world_from_holder) {
  TagLayout out{.name = layout.name, .tags = {}};
  for (const Tag& tag : layout.tags) {
    bool hidden = false;
    for (const Eigen::Vector3d& corner : corners_in_object(tag))
      hidden = hidden || behind_holder(bench, world_from_holder, world_from_layout * corner);
    if (!hidden) out.tags.push_back(tag);
  }
  return out;
}

Eigen::AngleAxisd turned(double angle_rad) {
  return {angle_rad, Eigen::Vector3d::UnitZ()};
}

}  // namespace

Lens full_size_lens() {
  return {.width_px = 6000,
          .height_px = 4000,
          .fx_px = 8400.0,
          .fy_px = 8395.0,
          .cx_px = 3010.0,
          .cy_px = 1985.0,
          .distortion = {-0.08, 0.1, 0.0003, -0.0002, 0.0}};
}

Bench bench(const Lens& lens) {
  Bench b{.lens = lens,
          .targets = {.ring = ring_of_tags(), .table = tags_on_table(), .table_height_mm = 0.2},
          .holder = tags_on_holder()};
  const Eigen::Vector3d centre(0, 0, 50), eye(600 * std::cos(30 * kDegree), 0, 50 + 600 * std::sin(30 * kDegree));
  const Eigen::Vector3d forward = (centre - eye).normalized(),
                        right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  b.world_from_camera.linear() << right, forward.cross(right), forward;
  b.world_from_camera.translation() = eye;
  b.world_from_camera.rotate(Eigen::AngleAxisd(0.5 * kDegree, Eigen::Vector3d(0.3, 0.5, 0.8).normalized()));
  b.world_from_ring = at({1.5, -0.7, 30.4}, 5 * kDegree);
  b.world_from_ring.rotate(Eigen::AngleAxisd(0.3 * kDegree, Eigen::Vector3d(0.8, -0.6, 0)));
  b.world_from_table.linear() = Eigen::AngleAxisd(0.4 * kDegree, Eigen::Vector3d(0.6, 0.8, 0)).toRotationMatrix();
  b.world_from_table.translate(Eigen::Vector3d(2, -3, 0.2));
  b.platform_from_holder = at({0.6, -0.8, 64}, 2 * kDegree);
  // +x of the world is the horizontal direction to the camera: turn everything that was placed about the axis.
  const double azimuth = std::atan2(b.world_from_camera.translation().y(), b.world_from_camera.translation().x());
  b.world_from_camera = turned(-azimuth) * b.world_from_camera;
  return b;
}

std::vector<double> usual_readings_rad() {
  std::vector<double> readings;
  for (int degrees = -60; degrees <= 60; degrees += 15) readings.push_back(degrees * kDegree);
  return readings;
}

std::vector<PlatformPicture> turning_views(const Bench& b, const std::vector<double>& readings_rad, double sigma_px,
                                           std::mt19937& random) {
  std::vector<PlatformPicture> views;
  const Eigen::Isometry3d camera_from_world = b.world_from_camera.inverse();
  for (const double reading : readings_rad) {
    PlatformPicture view{.reading_rad = reading, .seen = {}};
    add(view.seen, observe(b.lens, b.targets.ring, camera_from_world * turned(b.scale * reading) * b.world_from_ring,
                           sigma_px, random));
    add(view.seen, observe(b.lens, b.targets.table, camera_from_world * b.world_from_table, sigma_px, random));
    views.push_back(view);
  }
  return views;
}

TagObservation holder_view(const Bench& b, double angle_rad, double sigma_px, std::mt19937& random) {
  const Eigen::Isometry3d camera_from_world = b.world_from_camera.inverse();
  const Eigen::Isometry3d world_from_holder = turned(angle_rad) * b.platform_from_holder,
                          world_from_ring = turned(angle_rad) * b.world_from_ring;
  TagObservation seen = observe(b.lens, b.holder, camera_from_world * world_from_holder, sigma_px, random);
  add(seen, observe(b.lens, visible(b, b.targets.ring, world_from_ring, world_from_holder),
                    camera_from_world * world_from_ring, sigma_px, random));
  add(seen, observe(b.lens, visible(b, b.targets.table, b.world_from_table, world_from_holder),
                    camera_from_world * b.world_from_table, sigma_px, random));
  return seen;
}

Eigen::Vector4d axis_error(const PlatformFit& found, const Bench& b) {
  const Eigen::Isometry3d true_from_fitted = b.world_from_camera * found.world_from_camera.inverse();
  const Eigen::Vector3d direction = true_from_fitted.linear().col(2), origin = true_from_fitted.translation();
  return {-direction.y(), direction.x(), origin.x(), origin.y()};
}

}  // namespace calibration::synthetic
