#include "station/thread/validate/synthetic_views.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "renderer/trace/path_tracer.h"
#include "rig/simulated/noise.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/bench/mounted_holder.h"
#include "station/documents/plan.h"

namespace station {
namespace {

constexpr int kMaskSamples = 8;
constexpr double kFrameAlbedo = 0;  // as the model takes it

inversion::NearLight near_light(const rig::TrueLamp& lamp, const Eigen::Isometry3d& holder_from_world) {
  return {.position = holder_from_world * lamp.position,
          .intensity = lamp.intensity,
          .radius_mm = lamp.radius_mm,
          .beam_axis = holder_from_world.linear() * (lamp.aim - lamp.position).normalized(),
          .beam_exponent = lamp.beam_exponent};
}

// A pinhole camera with the true lens's field of view; the true optical axis is in the middle of the picture.
renderer::Camera pooled_camera(const rig::TrueLens& truth, calibration::Lens lens,
                               const Eigen::Isometry3d& holder_from_camera, int width_px, int height_px) {
  const double scale = static_cast<double>(width_px) / truth.width_px;
  const calibration::Lens true_lens = lens_of(truth);
  lens.distortion = {};
  renderer::Camera camera = camera_of(lens, holder_from_camera, true);
  const renderer::Camera true_camera = camera_of(true_lens, holder_from_camera, true);
  camera.width = width_px, camera.height = height_px;
  camera.fx *= scale, camera.fy *= scale;
  camera.cx = (width_px - 1) / 2.0 + scale * (camera.cx - true_camera.cx);
  camera.cy = (height_px - 1) / 2.0 + scale * (camera.cy - true_camera.cy);
  return camera;
}

const rig::BenchTruth& truth_of(const RigFile& rig) {
  if (!rig.simulation)
    throw std::runtime_error("rig \"" + rig.name + "\" has no \"simulation\" part; there are no views to make");
  return rig.simulation->truth;
}

}  // namespace

std::vector<inversion::View> synthetic_views(const RigFile& rig, const inversion::WrappedSpool& spool, int width_px,
                                             int height_px, const RigCalibration* calibrated) {
  const rig::BenchTruth& truth = truth_of(rig);
  const Plan plan = make_capture_plan(
      {.reflection_angles_deg = rig.reflection_angles_deg, .transmission_angles_deg = rig.transmission_angles_deg});
  std::vector<inversion::View> views;
  for (const PlanStep& step : plan.steps) {
    if (step.kind != StepKind::view) continue;
    const Eigen::Isometry3d holder_from_world = (Eigen::AngleAxisd(step.platform_angle_rad, Eigen::Vector3d::UnitZ()) *
                                                 nominal_holder_pose(rig, spool, step.mounting))
                                                    .inverse();
    inversion::View& view = views.emplace_back();
    view.id = step.id;
    view.transmission = is_transmission(step);
    if (calibrated) {
      view.camera = pooled_camera(truth.lens, calibrated->lens.lens,
                                  holder_from_world * calibrated->platform.world_from_camera, width_px, height_px);
      view.light = lamp_in_holder(*calibrated, rig, step.lamp, holder_from_world);
    } else {
      view.camera = pooled_camera(truth.lens, lens_of(truth.lens), holder_from_world * truth.lens.world_from_camera,
                                  width_px, height_px);
      view.light = near_light(view.transmission ? truth.back : truth.front, holder_from_world);
    }
    view.mask = inversion::thread_mask(spool, view.camera, view.light, kMaskSamples);
  }
  return views;
}

BackLitSwatch back_lit_swatch(const RigFile& rig, int width_px, int height_px) {
  constexpr double kBorder_mm = 10;
  const rig::BenchTruth& truth = truth_of(rig);
  const Eigen::Isometry3d frame_from_world(Eigen::Translation3d(0, 0, -rig.platform_height_mm));
  BackLitSwatch swatch{.shape = {60, 60}, .frame_from_swatch = Eigen::Isometry3d::Identity(), .view = {}};
  inversion::View& view = swatch.view;
  view.id = "behind";
  view.transmission = true;
  view.camera = pooled_camera(truth.lens, lens_of(truth.lens), frame_from_world * truth.lens.world_from_camera,
                              width_px, height_px);
  view.light = near_light(truth.back, frame_from_world);
  // In the platform's axis, where the camera looks.
  const renderer::CameraRay ray = renderer::ray_through(view.camera, view.camera.cx, view.camera.cy);
  const Eigen::Vector2d from = ray.origin.head<2>(), along = ray.direction.head<2>();
  const double height_mm = ray.origin.z() - ray.direction.z() * from.dot(along) / along.squaredNorm();
  const Eigen::Vector3d face(from.normalized().x(), from.normalized().y(), 0);
  swatch.frame_from_swatch.translation() = Eigen::Vector3d(0, 0, height_mm);
  swatch.frame_from_swatch.linear() << Eigen::Vector3d::UnitZ().cross(face), Eigen::Vector3d::UnitZ(), face;
  const Eigen::Isometry3d swatch_from_frame = swatch.frame_from_swatch.inverse();
  const Eigen::Array2d most = Eigen::Array2d(swatch.shape.width_mm, swatch.shape.height_mm) / 2 - kBorder_mm;
  view.mask = cv::Mat1b(height_px, width_px, uchar{0});
  for (int row = 0; row < height_px; ++row)
    for (int column = 0; column < width_px; ++column) {
      const renderer::CameraRay seen = renderer::ray_through(view.camera, column, row);
      const Eigen::Vector3d o = swatch_from_frame * seen.origin, d = swatch_from_frame.linear() * seen.direction;
      const Eigen::Vector2d at = (o - o.z() / d.z() * d).head<2>();
      if ((at.array().abs() < most).all()) view.mask(row, column) = 255;
    }
  return swatch;
}

std::vector<inversion::View> cylinder_views(const RigFile& rig, const renderer::CylinderShape& cylinder, int width_px,
                                            int height_px) {
  const rig::BenchTruth& truth = truth_of(rig);
  const Eigen::Isometry3d cylinder_from_world(Eigen::Translation3d(0, 0, -rig.platform_height_mm));
  std::vector<inversion::View> views;
  for (const auto& [id, lamp] : {std::pair("right", truth.front), std::pair("left", truth.front_left)}) {
    inversion::View& view = views.emplace_back();
    view.id = id;
    view.camera = pooled_camera(truth.lens, lens_of(truth.lens), cylinder_from_world * truth.lens.world_from_camera,
                                width_px, height_px);
    view.light = near_light(lamp, cylinder_from_world);
    view.mask = lit_side(cylinder, view.camera, view.light.position);
  }
  return views;
}

cv::Mat3f photograph(const inversion::View& view, const inversion::WrappedSpool& spool,
                     const std::vector<renderer::CurveSet>& curves, const PhotographOptions& options) {
  renderer::Scene scene;
  scene.curves = curves;
  scene.meshes.push_back(inversion::holder_frame(spool, kFrameAlbedo));
  scene.lights.push_back(inversion::sphere_light(view.light));
  const renderer::PathTracer tracer(std::move(scene));
  return tracer.render(view.camera, {.samples_per_pixel = options.samples_per_pixel,
                                     .seed = options.seed,
                                     .only = view.mask,
                                     .progress = options.progress});
}

SensedPicture with_sensor_noise(const cv::Mat3f& radiance, const cv::Mat1b& mask, const rig::TrueSensor& sensor,
                                double target_level, std::uint64_t seed) {
  std::vector<float> levels;
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.cols; ++column)
      if (mask(row, column))
        levels.push_back(*std::max_element(radiance(row, column).val, radiance(row, column).val + 3));
  if (levels.empty()) return {.radiance = radiance, .noise = {}};
  const auto brightest = levels.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(levels.size() - 1));
  std::nth_element(levels.begin(), brightest, levels.end());
  const double exposure_s = *brightest > 0 ? target_level / *brightest : 1.0;
  const double range_dn = sensor.white_level_dn - sensor.black_level_dn;
  const double dn_per_electron = range_dn / sensor.full_well_e;
  rig::NoiseStream noise(seed, 0);
  cv::Mat3f seen(radiance.size(), cv::Vec3f(0, 0, 0));
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.cols; ++column)
      for (int c = 0; c < 3; ++c) {
        const double electrons = radiance(row, column)[c] * exposure_s * sensor.full_well_e;
        const double spread = std::sqrt(std::max(0.0, electrons) + sensor.read_noise_e * sensor.read_noise_e);
        const double dn = std::round((electrons + spread * noise.normals().first) * dn_per_electron);
        seen(row, column)[c] = static_cast<float>(std::min(dn, range_dn) / (range_dn * exposure_s));
      }
  const double electrons_per_radiance = exposure_s * sensor.full_well_e, quantum_e = 1 / dn_per_electron;
  const double floor_e2 = sensor.read_noise_e * sensor.read_noise_e + quantum_e * quantum_e / 12;
  return {.radiance = seen,
          .noise = {.floor = Eigen::Array3d::Constant(floor_e2 / (electrons_per_radiance * electrons_per_radiance)),
                    .slope = Eigen::Array3d::Constant(1 / electrons_per_radiance)}};
}

}  // namespace station
