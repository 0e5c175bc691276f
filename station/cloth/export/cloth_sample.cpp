#include "station/cloth/export/cloth_sample.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "renderer/scene/cloth_shape.h"
#include "renderer/scene/patch_curves.h"
#include "station/cloth/render/build_scene.h"
#include "station/documents/bundle_file.h"
#include "station/documents/degree.h"
#include "station/documents/draft_file.h"
#include "station/output/watched_work.h"

namespace station {
namespace {

using Eigen::Vector3d;

constexpr double kFar_mm = 1e6;  // of cameras and lights: a period is a millionth of it
constexpr double kLightRadius_rad = 3 * kDegree;
constexpr double kMostDifference = 0.1;  // of a yarn's diameter from its thread's

void check_diameter(const renderer::YarnSystem& system, const ClothThread& thread, const std::filesystem::path& draft,
                    const std::filesystem::path& file, const char* name) {
  if (std::abs(system.diameter_mm / thread.diameter_mm - 1) <= kMostDifference) return;
  char text[160];
  std::snprintf(text, sizeof text, ": the %s is drafted %.3f mm thick and the thread ", name, system.diameter_mm);
  char found[64];
  std::snprintf(found, sizeof found, " is %.3f mm", thread.diameter_mm);
  throw std::runtime_error(draft.string() + text + file.string() + found +
                           "; draft the cloth for its threads, or take others");
}

}  // namespace

ClothSample cloth_of_scene(const std::filesystem::path& file, ProgressDisplay& progress) {
  const SceneFile scene = read_scene(file);
  const auto refuse = [&](const std::string& found) {
    throw std::runtime_error(file.string() + ": " + found +
                             "; textures are made of one flat cloth: give a scene with one two-scale swatch");
  };
  if (scene.cloths.size() != 1) refuse("it has " + std::to_string(scene.cloths.size()) + " cloths");
  const SceneCloth& cloth = scene.cloths.front();
  if (std::holds_alternative<renderer::CylinderShape>(cloth.shape)) refuse("its cloth is rolled up as a cylinder");
  if (!std::holds_alternative<renderer::SwatchShape>(cloth.shape)) refuse("its cloth lies on a mesh or garment");
  if (!cloth.two_scale) refuse("its cloth is drawn by brute force");
  return {.name = scene.name,
          .patch = woven_cloth(scene, 0, progress),
          .threads = scene.threads,
          .linear_srgb_from_camera = scene.linear_srgb_from_camera};
}

ClothSample cloth_of_draft(const std::filesystem::path& file, const std::filesystem::path& warp,
                           const std::filesystem::path& weft, ProgressDisplay& progress) {
  renderer::Draft draft = read_draft(file);
  const ClothThread warp_thread = read_cloth_thread(warp), weft_thread = read_cloth_thread(weft);
  check_diameter(draft.warp, warp_thread, file, warp, "warp");
  check_diameter(draft.weft, weft_thread, file, weft, "weft");
  draft.warp.threads = {0};
  draft.weft.threads = {1};
  draft.unevenness.shades = 1;
  draft.slubs.shade_mm = 0;
  return {.name = draft.name,
          .patch = weave_watched(draft, progress).patch,
          .threads = {warp_thread.scattering, weft_thread.scattering},
          .linear_srgb_from_camera = warp_thread.linear_srgb_from_camera};
}

renderer::Scene endless_cloth(const ClothSample& cloth) {
  const renderer::YarnPatch& patch = cloth.patch;
  const double margin_mm = 60 * patch.thickness_mm;  // light seeps sideways by a few thicknesses
  const auto side = [margin_mm](double period_mm) { return (2 * std::ceil(margin_mm / period_mm) + 1) * period_mm; };
  const renderer::SwatchShape swatch{side(patch.period_x_mm), side(patch.period_y_mm)};
  renderer::Scene scene;
  scene.cloths.push_back({.surface = renderer::surface_of(swatch, patch, Eigen::Isometry3d::Identity()),
                          .patch = patch,
                          .threads = cloth.threads});
  return scene;
}

renderer::Camera camera_of_period(const ClothSample& cloth, const Vector3d& to_view, int width_px, int height_px,
                                  int periods) {
  const bool straight = std::hypot(to_view.x(), to_view.y()) < 1e-9;
  renderer::Camera camera =
      renderer::look_at(kFar_mm * to_view, Vector3d::Zero(), straight ? Vector3d::UnitY() : Vector3d::UnitZ());
  const bool along_x = !straight && std::abs(to_view.x()) > std::abs(to_view.y());
  const double across_mm = periods * (along_x ? cloth.patch.period_y_mm : cloth.patch.period_x_mm),
               upright_mm =
                   periods * (along_x ? cloth.patch.period_x_mm : cloth.patch.period_y_mm) * std::abs(to_view.z());
  camera.width = width_px, camera.height = height_px;
  camera.fx = width_px * kFar_mm / across_mm;
  camera.fy = height_px * kFar_mm / upright_mm;
  camera.cx = (width_px - 1) / 2.0, camera.cy = (height_px - 1) / 2.0;
  return camera;
}

renderer::SphereLight distant_light(const Vector3d& to_light) {
  const double sine = std::sin(kLightRadius_rad);
  return {.center = kFar_mm * to_light,
          .radius_mm = kFar_mm * sine,
          .radiance = Vector3d::Constant(1 / (sine * sine)),
          .visible = false};
}

renderer::EnvironmentLight half_surroundings(bool above) {
  // Between the two rows at the horizon the light fades over 0.35 degrees, where a surface hardly receives any.
  constexpr int kRows = 512;
  cv::Mat3f radiance(kRows, 4, cv::Vec3f::all(0));
  radiance.rowRange(above ? 0 : kRows / 2, above ? kRows / 2 : kRows).setTo(cv::Scalar::all(1));
  return {.radiance = radiance, .visible = false};
}

cv::Mat3f in_linear_srgb(const ClothSample& cloth, const cv::Mat3f& camera_rgb) {
  cv::Matx33f matrix;
  std::copy(cloth.linear_srgb_from_camera.begin(), cloth.linear_srgb_from_camera.end(), matrix.val);
  cv::Mat3f converted;
  cv::transform(camera_rgb, converted, matrix);
  return converted;
}

cv::Mat3f render_or_stop(const renderer::PathTracer& tracer, const renderer::Camera& camera, int samples_per_pixel,
                         std::uint64_t seed, const PartProgress& go_on) {
  renderer::Film film = renderer::empty_film(camera.width, camera.height);
  if (!tracer.refine(camera, {.samples_per_pixel = samples_per_pixel, .seed = seed, .progress = go_on}, film))
    throw std::runtime_error(
        "the export was stopped on request and nothing is left of it; the same command begins again");
  return renderer::mean_radiance(film);
}

}  // namespace station
