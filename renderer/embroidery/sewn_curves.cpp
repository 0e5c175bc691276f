#include "renderer/embroidery/sewn_curves.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace renderer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The triangles of a surface by where they lie in the patch.
class PatchMap {
 public:
  explicit PatchMap(const ClothSurface& surface) : surface_(surface) {
    for (const Vector2d& at : surface.patch_mm) bounds_.extend(at);
    const double count = static_cast<double>(surface.triangles.size());
    side_ = std::clamp(static_cast<int>(std::sqrt(count)), 1, 1024);
    cells_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      Eigen::AlignedBox2d box;
      for (const std::uint32_t corner : surface.triangles[t]) box.extend(surface.patch_mm[corner]);
      const Eigen::Vector2i from = cell_of(box.min()), to = cell_of(box.max());
      for (int y = from.y(); y <= to.y(); ++y)
        for (int x = from.x(); x <= to.x(); ++x) cells_[index({x, y})].push_back(t);
    }
  }

  // World position of a place of the patch, `height_mm` above the surface.
  Vector3d at(const Vector2d& patch_mm, double height_mm) const {
    constexpr double kRounding = 1e-9;
    for (const std::uint32_t t : cells_[index(cell_of(patch_mm))]) {
      const auto& corner = surface_.triangles[t];
      const Vector2d &a = surface_.patch_mm[corner[0]], &b = surface_.patch_mm[corner[1]],
                     &c = surface_.patch_mm[corner[2]];
      Eigen::Matrix2d edges;
      edges << b - a, c - a;
      const Vector2d uv = edges.inverse() * (patch_mm - a);
      const Vector3d weights(1 - uv.sum(), uv.x(), uv.y());
      if (!(weights.minCoeff() >= -kRounding)) continue;
      Vector3d position = Vector3d::Zero(), normal = Vector3d::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        position += weights[static_cast<int>(k)] * surface_.vertices[corner[k]];
        normal += weights[static_cast<int>(k)] * surface_.normals[corner[k]];
      }
      return position + height_mm * normal.normalized();
    }
    char line[240];
    std::snprintf(
        line, sizeof line,
        "embroidery: a stitch at %.1f, %.1f mm of the cloth lies beside it (its cloth spans %.1f to %.1f, %.1f to "
        "%.1f mm); move the motif or take a larger cloth",
        patch_mm.x(), patch_mm.y(), bounds_.min().x(), bounds_.max().x(), bounds_.min().y(), bounds_.max().y());
    throw std::runtime_error(line);
  }

 private:
  Eigen::Vector2i cell_of(const Vector2d& patch_mm) const {
    const Vector2d share = (patch_mm - bounds_.min()).cwiseQuotient(bounds_.sizes().cwiseMax(1e-12));
    const auto cell = [&](double s) { return static_cast<int>(std::clamp(s * side_, 0.0, side_ - 1.0)); };
    return {cell(share.x()), cell(share.y())};
  }
  std::size_t index(const Eigen::Vector2i& cell) const {
    return static_cast<std::size_t>(cell.y()) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(cell.x());
  }

  const ClothSurface& surface_;
  Eigen::AlignedBox2d bounds_;
  int side_ = 1;
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace

Vector2d MotifPlace::on_cloth(const Vector2d& motif_mm) const {
  return at_mm + Eigen::Rotation2Dd(turn_rad) * motif_mm;
}

Vector2d middle_of(const ClothSurface& surface) {
  Eigen::AlignedBox2d bounds;
  for (const Vector2d& at : surface.patch_mm) bounds.extend(at);
  return bounds.center();
}

std::vector<CurveSet> sewn_curves(std::vector<CurveSet> flat, const MotifPlace& place, const ClothSurface& surface,
                                  double height_mm) {
  const PatchMap map(surface);
  for (CurveSet& set : flat)
    for (Eigen::Vector4f& point : set.control_points) {
      const Eigen::Vector4d from = point.cast<double>();
      point.head<3>() = map.at(place.on_cloth(from.head<2>()), height_mm + from.z()).cast<float>();
    }
  return flat;
}

}  // namespace renderer
