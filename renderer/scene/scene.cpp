#include "renderer/scene/scene.h"

#include <cassert>
#include <cmath>

namespace renderer {
namespace {

// The point that makes a uniform cubic B-spline start at `end`, in the direction of `neighbour`.
Eigen::Vector4f mirrored(const Eigen::Vector4f& end, const Eigen::Vector4f& neighbour) {
  Eigen::Vector4f point = 2 * end - neighbour;
  point.w() = std::max(point.w(), 0.0f);
  return point;
}

}  // namespace

void CurveSet::add_clamped_curve(const std::vector<Eigen::Vector4f>& points) {
  assert(points.size() >= 2);
  const auto first = static_cast<std::uint32_t>(control_points.size());
  control_points.push_back(mirrored(points[0], points[1]));
  control_points.insert(control_points.end(), points.begin(), points.end());
  control_points.push_back(mirrored(points.back(), points[points.size() - 2]));
  for (std::uint32_t i = 0; i + 1 < points.size(); ++i) segments.push_back(first + i);
}

Eigen::Vector2i AbsorptionTexture::texel_at(const Eigen::Vector2d& patch_mm) const {
  const auto repeated = [](double place, int size) {
    const double into = place - std::floor(place / size) * size;
    return std::min(static_cast<int>(into), size - 1);
  };
  return {repeated(patch_mm.x() / texel_mm.x(), sigma_a.cols),
          sigma_a.rows - 1 - repeated(patch_mm.y() / texel_mm.y(), sigma_a.rows)};
}

double beam_factor(const SphereLight& light, const Eigen::Vector3d& point) {
  if (light.beam_exponent == 0.0) return 1.0;
  const double cosine = light.beam_axis.dot((point - light.center).normalized());
  return cosine > 0.0 ? std::pow(cosine, light.beam_exponent) : 0.0;
}

std::vector<ScatteringModel> scattering_models(const Scene& scene) {
  std::vector<ScatteringModel> models;
  for (const CurveSet& set : scene.curves) models.push_back(set.scattering);
  for (const Cloth& cloth : scene.cloths) {
    models.insert(models.end(), cloth.threads.begin(), cloth.threads.end());
    if (cloth.flyaways) models.emplace_back(cloth.flyaways->fiber);
  }
  return models;
}

}  // namespace renderer
