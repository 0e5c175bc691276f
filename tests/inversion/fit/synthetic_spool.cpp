#include "tests/inversion/fit/synthetic_spool.h"

#include <cmath>

#include "inversion/view/agreement.h"
#include "renderer/scattering/degree.h"

namespace inversion {
namespace {

constexpr double kCameraDistance_mm = 600, kLampDistance_mm = 500;
constexpr double kShownWidth_mm = 74;  // the frame is 68 mm wide
constexpr int kMaskSamples = 4;

Eigen::Vector3d direction(double azimuth_deg, double elevation_deg) {
  const double azimuth = azimuth_deg * renderer::kDegree, elevation = elevation_deg * renderer::kDegree;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

}  // namespace

renderer::ThreadParameters known_thread() {
  renderer::ThreadParameters p;
  p.sigma_a = {0.15, 0.4, 0.9};
  p.alpha = {0.25, 0.35, 0.45};
  p.beta = {0.35, 0.75, 0.3};
  p.r0a = -0.05, p.r0b = -0.13, p.r0c = 0.3;
  p.r1a = 0.7;
  p.r2a = 6, p.r2b = 3, p.r2c = 0;
  return p;
}

renderer::ThreadParameters white_thread() {
  renderer::ThreadParameters p = known_thread();
  p.sigma_a = {0, 0.02, 0.05};
  p.r0a = 0, p.r0b = -0.3, p.r0c = 0.7;
  p.r1a = 0.5;
  p.r2a = 10, p.r2b = 5;
  return p;
}

std::array<double, 3> energies_at(renderer::ThreadParameters parameters, double c) {
  parameters.limit_energy = false;
  return renderer::thread_lobe_energies(parameters, c);
}

View unlit_view(const WrappedSpool& spool, const Standpoint& at, int width_px) {
  View view;
  view.id = at.id;
  view.transmission = std::abs(at.lamp_azimuth_deg) > 90;
  const Eigen::Vector3d up = at.threads_upright ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  view.camera = renderer::look_at(kCameraDistance_mm * direction(at.camera_azimuth_deg, at.camera_elevation_deg),
                                  Eigen::Vector3d::Zero(), up);
  const int height_px = width_px * 2 / 3;
  view.camera.width = at.threads_upright ? height_px : width_px;
  view.camera.height = at.threads_upright ? width_px : height_px;
  view.camera.fx = view.camera.fy = width_px * kCameraDistance_mm / kShownWidth_mm;
  view.camera.cx = (view.camera.width - 1) / 2.0, view.camera.cy = (view.camera.height - 1) / 2.0;
  view.light.position = kLampDistance_mm * direction(at.lamp_azimuth_deg, at.lamp_elevation_deg);
  view.light.intensity = {3e5, 2.5e5, 2e5};
  view.mask = thread_mask(spool, view.camera, view.light, kMaskSamples);
  return view;
}

std::vector<Standpoint> six_standpoints() {
  return {{"lying-0", 0, 0, 8, 12},         {"lying-35", 35, 0, -15, 25},
          {"upright-0", 0, 0, 5, 30, true}, {"upright-50", 0, 50, 10, 20, true},
          {"through-0", 0, 0, 170, 10},     {"through-40", 40, 0, 200, 25}};
}

View photographed(View view, const WrappedSpool& spool, const renderer::ScatteringModel& thread, int samples_per_pixel,
                  std::uint64_t seed) {
  view.image = fitted_view(spool, view, thread, samples_per_pixel, seed);
  return view;
}

std::vector<View> photographs(const WrappedSpool& spool, const renderer::ScatteringModel& thread, int width_px,
                              int samples_per_pixel) {
  std::vector<View> views;
  for (const Standpoint& at : six_standpoints())
    views.push_back(photographed(unlit_view(spool, at, width_px), spool, thread, samples_per_pixel, 11 + views.size()));
  return views;
}

}  // namespace inversion
