#include "renderer/trace/cloth_reflectance.h"

#include <cmath>

#include "renderer/scene/cloth_shape.h"
#include "renderer/trace/scene_walk.h"

namespace renderer {
namespace {

using Eigen::Array3d;
using Eigen::Array3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

// The side of the traced cloth over its thickness: long enough that light at half a degree from the horizon meets yarns
// before it reaches the border.
constexpr double kSideOverThickness = 600;
constexpr float kFar_mm = 1e9f;

double height_above(const YarnPatch& patch) {
  double height = 0;
  for (const Yarn& yarn : patch.yarns)
    for (const Vector3d& point : yarn.control_points)
      height = std::max(height, std::abs(point.z()) + yarn.radius_mm * profile_bound(yarn.thickness));
  return 1.01 * height;
}

Scene scene_of(const YarnPatch& patch, const std::vector<ScatteringModel>& threads) {
  const double side = kSideOverThickness * 2 * height_above(patch);
  const SwatchShape shape{side, side};
  Scene scene;
  scene.cloths.push_back({surface_of(shape, patch, Eigen::Isometry3d::Identity()), patch, threads});
  return scene;
}

}  // namespace

ClothReflectance::ClothReflectance(const YarnPatch& patch, const std::vector<ScatteringModel>& threads)
    : period_mm_(patch.period_x_mm, patch.period_y_mm),
      above_mm_(height_above(patch)),
      rays_(scene_of(patch, threads)),
      models_(prepare_curve_models(scattering_models(rays_.scene()))) {}

Array3d ClothReflectance::sample(const Vector3d& wi, const Vector3d& wo, Sampler& sampler) const {
  const Eigen::Vector2f u = sampler.next_2d();
  const Vector3d place((u.x() - 0.5) * period_mm_.x(), (u.y() - 0.5) * period_mm_.y(), 0);
  const Vector3f light = wi.cast<float>();
  Ray ray{(place + wo * (above_mm_ / wo.z())).cast<float>(), -wo.cast<float>()};
  Array3f sum = Array3f::Zero(), throughput = Array3f::Ones();
  SceneWalk walk(rays_, models_);
  for (int vertices = 0; vertices < kMostVertices; ++vertices) {
    const std::optional<SurfaceHit> hit = walk.next(ray, sampler);
    if (!hit) break;
    const PathVertex vertex(*hit, -ray.direction, models_);
    const Array3f lit = vertex.evaluate(light).f_cos;
    if (lit.maxCoeff() > 0 && !walk.occluded(vertex.ray_toward(light, sampler).ray, kFar_mm, sampler))
      sum += throughput * lit;
    const Vector3f onward = vertex.sample(sampler);
    const ScatteringValue<float> scattering = vertex.evaluate(onward);
    if (!(scattering.pdf > 0)) break;
    throughput *= scattering.f_cos / scattering.pdf;
    if (!(throughput.maxCoeff() > 0)) break;
    if (vertices + 1 >= kFirstRouletteVertex) {
      const float survival = std::min(kMostSurvival, throughput.maxCoeff());
      if (!(sampler.next_1d() < survival)) break;
      throughput /= survival;
    }
    ray = vertex.ray_toward(onward, sampler).ray;
  }
  return sum.cast<double>() / wi.z();  // irradiance is the cosine
}

}  // namespace renderer
