#include "tests/calibration/geometry/synthetic_views.h"

#include <array>
#include <numbers>
#include <span>

#include "calibration/geometry/target_stand.h"
#include "calibration/sensor/degree.h"

namespace calibration::synthetic {
namespace {

// Written here once more, so that the library's own projection is not its own judge (Brown's model, OpenCV order).
Eigen::Vector2d distort(const Lens& lens, double x, double y) {
  const auto& [k1, k2, p1, p2, k3] = lens.distortion;
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

Eigen::Vector3d ray(const Lens& lens, double column, double row) {
  const Eigen::Vector2d seen((column - lens.cx_px) / lens.fx_px, (row - lens.cy_px) / lens.fy_px);
  Eigen::Vector2d straight = seen;
  for (int i = 0; i < 6; ++i) straight += seen - distort(lens, straight.x(), straight.y());
  return {straight.x(), straight.y(), 1.0};
}

}  // namespace

Lens narrow_lens() {
  return {.width_px = 600,
          .height_px = 400,
          .fx_px = 2402.0,
          .fy_px = 2397.0,
          .cx_px = 303.0,
          .cy_px = 196.0,
          .distortion = {-0.15, 0.6, 0.0008, -0.0006, 0.0}};
}

TagLayout board() {
  return make_tag_board("test board", 3, 4, 20.0, 30.0, 0);
}

Eigen::Vector2d project(const Lens& lens, const Eigen::Vector3d& point_in_camera) {
  const Eigen::Vector2d d =
      distort(lens, point_in_camera.x() / point_in_camera.z(), point_in_camera.y() / point_in_camera.z());
  return {lens.fx_px * d.x() + lens.cx_px, lens.fy_px * d.y() + lens.cy_px};
}

Eigen::Isometry3d facing(double distance_mm, double yaw_rad, double pitch_rad, double roll_rad,
                         const Eigen::Vector2d& shift_mm) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(shift_mm.x(), shift_mm.y(), distance_mm));
  pose.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));  // object +y up against camera +y down
  pose.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()));
  pose.rotate(Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitX()));
  pose.rotate(Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()));
  return pose;
}

TagObservation observe(const Lens& lens, const TagLayout& layout, const Eigen::Isometry3d& camera_from_object,
                       double sigma_px, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, 1.0);
  TagObservation seen;
  for (const Tag& tag : layout.tags) {
    TagDetection detection{.id = tag.id, .corners_px = {}};
    bool inside = true;
    const auto corners = corners_in_object(tag);
    for (std::size_t c = 0; c < 4; ++c) {
      const Eigen::Vector2d pixel = project(lens, camera_from_object * corners[c]);
      inside =
          inside && pixel.x() > 2 && pixel.y() > 2 && pixel.x() < lens.width_px - 3 && pixel.y() < lens.height_px - 3;
      const double dx = noise(random), dy = noise(random);
      detection.corners_px[c] = pixel + sigma_px * Eigen::Vector2d(dx, dy);
    }
    if (inside) seen.push_back(detection);
  }
  return seen;
}

BoardPicture observe_lattice(const Lens& lens, const Lattice& lattice, const Eigen::Vector2d& bow_mm,
                             const Eigen::Isometry3d& camera_from_lattice) {
  BoardPicture seen;
  for (int row = 0; row < lattice.rows; ++row) {
    for (int column = 0; column < lattice.columns; ++column) {
      const double u = 2.0 * column / (lattice.columns - 1) - 1.0, v = 2.0 * row / (lattice.rows - 1) - 1.0;
      Eigen::Vector3d point = lattice.point(column, row);
      point.z() = bow_mm.x() * (1.0 - u * u) + bow_mm.y() * (1.0 - v * v);
      const Eigen::Vector2d pixel = project(lens, camera_from_lattice * point);
      if (pixel.minCoeff() > 2 && pixel.x() < lens.width_px - 3 && pixel.y() < lens.height_px - 3)
        seen.push_back({column, row, pixel});
    }
  }
  return seen;
}

std::vector<Eigen::Isometry3d> handheld_poses(int count, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const double distance_mm = 600.0 + 150.0 * unit(random);
    const double yaw = 40.0 * kDegree * unit(random), pitch = 40.0 * kDegree * unit(random);
    const double roll = 20.0 * kDegree * unit(random);
    const double dx = 30.0 * unit(random), dy = 18.0 * unit(random);
    poses.push_back(facing(distance_mm, yaw, pitch, roll, {dx, dy}));
  }
  return poses;
}

Eigen::Isometry3d put_down(const Eigen::Isometry3d& platform_from_object, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double forward_mm = 30 * unit(random), right_mm = 30 * unit(random), turn_rad = 15 * kDegree * unit(random);
  return Eigen::Translation3d(forward_mm, right_mm, 0) * Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()) *
         platform_from_object;
}

std::vector<Eigen::Isometry3d> stand_poses(const RoughCamera& camera, const TagLayout& board,
                                           const Eigen::Vector2d& plate_mm, int pictures, std::mt19937& random,
                                           std::size_t stands) {
  constexpr std::array<std::pair<int, bool>, 4> kAsked{{{0, false}, {2, true}, {3, false}, {1, true}}};
  std::vector<Eigen::Isometry3d> poses;
  for (const auto& [stand, on_its_side] : std::span(kAsked).first(stands)) {
    Eigen::Isometry3d on = on_stand(kStandLeans_rad.at(static_cast<std::size_t>(stand)),
                                    on_its_side ? plate_mm.x() : plate_mm.y(), 88, 30);
    if (on_its_side) on.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));
    const Eigen::Isometry3d standing = put_down(on, random);
    for (const double angle : plan_board_angles(camera, board, standing, pictures, std::numbers::pi))
      poses.push_back(camera.world_from_camera.inverse() * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) *
                      standing);
  }
  return poses;
}

cv::Mat1f picture(const Lens& lens, const TagLayout& layout, const Eigen::Isometry3d& camera_from_object, int samples) {
  constexpr float kPaper = 0.8F, kInk = 0.04F, kSurround = 0.1F;
  struct Print {
    Eigen::Matrix3d tag_from_camera;  // directions
    Eigen::Vector3d eye;              // camera centre on the tag
    double cell_mm;                   // the bitmap has a white border of one cell around the black square
    cv::Mat1b bitmap;
  };
  std::vector<Print> prints;
  for (const Tag& tag : layout.tags) {
    const Eigen::Isometry3d tag_from_camera = (camera_from_object * tag.object_from_tag).inverse();
    prints.push_back({tag_from_camera.linear(), tag_from_camera.translation(), tag.size_mm / 8.0, tag_bitmap(tag.id)});
  }
  const auto value_along = [&](const Eigen::Vector3d& direction) {
    float value = kSurround;
    for (const Print& print : prints) {
      const Eigen::Vector3d along = print.tag_from_camera * direction;
      if (!(along.z() < 0.0)) continue;
      const double reach = -print.eye.z() / (along.z() * print.cell_mm);
      const double column = print.eye.x() / print.cell_mm + along.x() * reach + 5.0;
      const double row = 5.0 - print.eye.y() / print.cell_mm - along.y() * reach;
      if (column < -2.0 || row < -2.0 || column >= 12.0 || row >= 12.0) continue;
      value = kPaper;
      if (column < 0.0 || row < 0.0 || column >= 10.0 || row >= 10.0) continue;
      return print.bitmap(static_cast<int>(row), static_cast<int>(column)) > 0 ? kPaper : kInk;
    }
    return value;
  };
  cv::Mat1f grey(lens.height_px, lens.width_px);
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      float sum = 0.0F;
      for (int s = 0; s < samples * samples; ++s) {
        const double dx = (s % samples + 0.5) / samples - 0.5, dy = (s / samples + 0.5) / samples - 0.5;
        sum += value_along(ray(lens, column + dx, row + dy));
      }
      grey(row, column) = sum / static_cast<float>(samples * samples);
    }
  }
  return grey;
}

}  // namespace calibration::synthetic
