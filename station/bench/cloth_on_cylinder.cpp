#include "station/bench/cloth_on_cylinder.h"

#include <algorithm>
#include <cmath>

#include "renderer/scene/cloth_shape.h"
#include "renderer/weave/patch_measures.h"
#include "station/bench/bench_objects.h"
#include "station/documents/degree.h"

namespace station {
namespace {

constexpr int kMostColumns = 1024;  // that are looked at; between them a cylinder has no surprises
constexpr double kRim_mm = 3;
const double kLeastCosine = std::cos(75 * kDegree);

}  // namespace

std::optional<Eigen::Vector3d> side_point(const renderer::CameraRay& ray, double radius_mm) {
  const Eigen::Vector2d o = ray.origin.head<2>(), d = ray.direction.head<2>();
  const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - radius_mm * radius_mm;
  const double root = b * b - a * c;
  if (a == 0 || root < 0 || c <= 0 || b >= 0) return std::nullopt;
  return ray.origin + (-b - std::sqrt(root)) / a * ray.direction;
}

void add_cloth_on_cylinder(renderer::Scene& scene, const renderer::CylinderShape& cylinder,
                           const renderer::YarnPatch& patch, const std::vector<renderer::ScatteringModel>& threads) {
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  renderer::CylinderShape cloth = cylinder;
  cloth.radius_mm -= renderer::surface_range(patch).low_mm;
  scene.cloths.push_back({renderer::surface_of(cloth, patch, here), patch, threads});
  scene.meshes.push_back(renderer::body_of(cylinder, here, cv::Vec3f::all(kBlackPaintAlbedo)));
}

int comparable_block_px(const renderer::YarnPatch& patch, const renderer::Camera& camera) {
  constexpr double kRepeats = 2;
  constexpr int kLeast_px = 8;
  const double distance_mm = camera.world_from_camera.translation().norm();
  const double repeat_mm = std::max(patch.period_x_mm, patch.period_y_mm);
  return std::max(kLeast_px, static_cast<int>(std::ceil(kRepeats * repeat_mm * camera.fx / distance_mm)));
}

cv::Mat1b lit_side(const renderer::CylinderShape& cylinder, const renderer::Camera& camera,
                   const Eigen::Vector3d& light_mm) {
  const auto is_lit = [&](int column, int row) {
    const renderer::CameraRay ray = renderer::ray_through(camera, column, row);
    const auto point = side_point(ray, cylinder.radius_mm);
    if (!point || point->z() < kRim_mm || point->z() > cylinder.height_mm - kRim_mm) return false;
    const Eigen::Vector3d normal = Eigen::Vector3d(point->x(), point->y(), 0).normalized();
    return normal.dot((light_mm - *point).normalized()) > kLeastCosine && -normal.dot(ray.direction) > kLeastCosine;
  };
  cv::Mat1b mask(camera.height, camera.width, static_cast<unsigned char>(0));
  const int block_px = (mask.cols + kMostColumns - 1) / kMostColumns;
  for (int top = 0; top < mask.rows; top += block_px)
    for (int left = 0; left < mask.cols; left += block_px) {
      const cv::Rect block = cv::Rect(left, top, block_px, block_px) & cv::Rect({0, 0}, mask.size());
      const int right = block.br().x - 1, bottom = block.br().y - 1;
      if (!is_lit(left, top)) continue;
      if (block_px == 1 || (is_lit(right, top) && is_lit(left, bottom) && is_lit(right, bottom)))
        mask(block).setTo(255);
    }
  return mask;
}

}  // namespace station
