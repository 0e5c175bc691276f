#include "station/cloth/cloth_colour.h"

#include <Eigen/Dense>
#include <stdexcept>

#include "calibration/light/colour_chart.h"
#include "renderer/picture/camera.h"
#include "renderer/picture/image_file.h"
#include "renderer/scene/cloth_shape.h"
#include "renderer/scene/patch_curves.h"
#include "renderer/trace/path_tracer.h"
#include "station/documents/matrix_rows.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

}  // namespace

AbsorptionCurves absorption_curves(const renderer::ThreadParameters& thread, int count,
                                   const std::function<Array3d(const renderer::ThreadParameters&)>& colour_of,
                                   const std::function<void(double)>& done) {
  int calls = 0;
  return inversion::measure_absorption_curves(
      [&](double sigma_a) {
        if (interrupted()) throw std::runtime_error("the measuring of the thread's colours was interrupted");
        done(static_cast<double>(calls++) / count);
        renderer::ThreadParameters coloured = thread;
        for (int c = 0; c < 3; ++c) coloured.sigma_a[c] = sigma_a;
        return colour_of(coloured);
      },
      count);
}

// The cloth is seen from above in its middle over one whole period, so that every crossing counts alike.
Array3d even_light_reflectance(const renderer::YarnPatch& patch, const renderer::ThreadParameters& thread,
                               std::uint64_t seed) {
  constexpr int kSide_px = 24, kSamples = 16, kMargin_periods = 4;
  constexpr double kEye_mm = 2000;
  const double width = patch.period_x_mm, height = patch.period_y_mm;
  const auto threads = static_cast<std::size_t>(1 + renderer::threads_of(patch).back());
  renderer::Scene scene;
  const renderer::SwatchShape swatch{.width_mm = 2 * kMargin_periods * width,
                                     .height_mm = 2 * kMargin_periods * height};
  scene.cloths.push_back({.surface = renderer::surface_of(swatch, patch, Eigen::Isometry3d::Identity()),
                          .patch = patch,
                          .threads = std::vector<renderer::ScatteringModel>(threads, thread)});
  scene.surroundings = renderer::EnvironmentLight{.radiance = cv::Mat3f(8, 16, cv::Vec3f(1, 1, 1))};
  renderer::Camera camera = renderer::look_at({width / 2, height / 2, kEye_mm}, {width / 2, height / 2, 0}, {0, 1, 0});
  camera.width = camera.height = kSide_px;
  camera.fx = kSide_px * kEye_mm / width;
  camera.fy = kSide_px * kEye_mm / height;
  camera.cx = camera.cy = (kSide_px - 1) / 2.0;
  const cv::Scalar mean =
      cv::mean(renderer::PathTracer(scene).render(camera, {.samples_per_pixel = kSamples, .seed = seed}));
  return {mean[0], mean[1], mean[2]};
}

ColouredThread coloured_thread(const ThreadFile& thread, const AbsorptionCurves& curves, const Srgb8& colour) {
  const Eigen::Matrix3d to_srgb = matrix_of(thread.linear_srgb_from_camera);
  const cv::Vec3f decoded = renderer::linear_of_srgb({colour[0], colour[1], colour[2]});
  const Vector3d linear(decoded[0], decoded[1], decoded[2]), wanted = to_srgb.inverse() * linear;
  ColouredThread made{.parameters = thread.parameters};
  Vector3d reached;
  for (int c = 0; c < 3; ++c) {
    const inversion::AbsorptionCurve& curve = curves[static_cast<std::size_t>(c)];
    made.parameters.sigma_a[c] = curve.sigma_a(wanted[c]);
    reached[c] = curve.reflectance(made.parameters.sigma_a[c]);
  }
  made.delta_e_2000 = calibration::delta_e_2000(calibration::lab_of_linear_srgb(linear),
                                                calibration::lab_of_linear_srgb((to_srgb * reached).cwiseMax(0)));
  return made;
}

ClothColours::ClothColours(const ThreadFile& thread, const renderer::YarnPatch& patch,
                           const std::function<void(double)>& done)
    : thread_(thread),
      curves_(absorption_curves(
          thread.parameters, 10, [&](const auto& coloured) { return even_light_reflectance(patch, coloured); }, done)) {
}

ColouredThread ClothColours::thread_of(const Srgb8& colour) const {
  return coloured_thread(thread_, curves_, colour);
}

}  // namespace station
