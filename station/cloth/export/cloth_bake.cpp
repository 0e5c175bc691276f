#include "station/cloth/export/cloth_bake.h"

#include <algorithm>
#include <cmath>

#include "renderer/trace/layers.h"
#include "renderer/trace/path_vertex.h"

namespace station {
namespace {

using Eigen::Vector3d;

constexpr int kLeastSide_px = 16;

// The mean normals, in the world frame, as unit vectors of the picture's frame.
cv::Mat3f tangent_normals(const cv::Mat3f& world, const renderer::Camera& camera) {
  const Eigen::Matrix3f axes = camera.world_from_camera.linear().cast<float>();
  cv::Mat3f normals(world.size());
  normals.forEach([&](cv::Vec3f& normal, const int* at) {
    const cv::Vec3f& mean = world(at[0], at[1]);
    const Eigen::Vector3f seen = axes.transpose() * Eigen::Vector3f(mean[0], mean[1], mean[2]);
    const Eigen::Vector3f unit =
        seen.norm() > 0 ? Eigen::Vector3f(seen.x(), -seen.y(), -seen.z()).normalized() : Eigen::Vector3f::UnitZ();
    normal = {unit.x(), unit.y(), unit.z()};
  });
  return normals;
}

class SideBaker {
 public:
  SideBaker(const ClothSample& cloth, const BakeOptions& options) : cloth_(cloth), options_(options) {}

  BakedSide bake(bool front) {
    const renderer::Camera camera = camera_of_period(cloth_, front ? Vector3d::UnitZ() : Vector3d(-Vector3d::UnitZ()),
                                                     options_.size_px.width, options_.size_px.height);
    BakedSide side;
    side.reflectance = lit(camera, front);
    side.transmittance = lit(camera, !front);
    const renderer::RayScene rays(endless_cloth(cloth_));
    const auto models = renderer::prepare_curve_models(renderer::scattering_models(rays.scene()));
    const renderer::PictureLayers layers =
        renderer::first_hit_layers(rays, models, camera, options_.samples_per_texel, options_.seed, 0);
    side.opacity = layers.cover;
    side.normal = tangent_normals(layers.normal, camera);
    return side;
  }

 private:
  cv::Mat3f lit(const renderer::Camera& camera, bool above) {
    constexpr double kPictures = 4;
    renderer::Scene scene = endless_cloth(cloth_);
    scene.surroundings = half_surroundings(above);
    const renderer::PathTracer tracer(std::move(scene));
    const double done = pictures_++ / kPictures;
    return in_linear_srgb(cloth_,
                          render_or_stop(tracer, camera, options_.samples_per_texel, options_.seed,
                                         [&](double part) { return options_.progress(done + part / kPictures); }));
  }

  const ClothSample& cloth_;
  const BakeOptions& options_;
  int pictures_ = 0;
};

}  // namespace

BakedCloth bake_cloth(const ClothSample& cloth, const BakeOptions& options) {
  SideBaker baker(cloth, options);
  return {.width_mm = cloth.patch.period_x_mm,
          .height_mm = cloth.patch.period_y_mm,
          .front = baker.bake(true),
          .back = baker.bake(false)};
}

cv::Size bake_size(const ClothSample& cloth, int longer_side_px) {
  const double x = cloth.patch.period_x_mm, y = cloth.patch.period_y_mm, scale = longer_side_px / std::max(x, y);
  const auto side = [scale](double mm) { return std::max(kLeastSide_px, static_cast<int>(std::lround(mm * scale))); };
  return {side(x), side(y)};
}

double bake_bytes(const cv::Size& size_px) {
  // The bytes of a texel: four pictures and the normals of each side (80), a film (36) with its mean (12), the maps of
  // each side (80), and their bytes and encoded files (40).
  constexpr double kPerTexel = 250;
  return kPerTexel * size_px.area();
}

}  // namespace station
