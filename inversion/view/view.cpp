#include "inversion/view/view.h"

#include <numbers>
#include <opencv2/imgproc.hpp>

#include "renderer/trace/path_tracer.h"

namespace inversion {
namespace {

constexpr double kFrameAlbedo = 0.0;  // matt black; what it reflects is below the camera's noise
constexpr int kLargestHole_px = 5;
// Photographs mix a pixel with its neighbours (demosaicing, undistortion, half a pixel of calibration): at its border
// a dark thread takes over the lit frame beside it. A mask's border of this width is left out.
constexpr int kBorder_px = 2;
// The most columns of a picture that is rendered for a mask: at 24 MP one pixel stands for 36, and a fit's blocks are
// twice as wide as the border is then.
constexpr int kMostColumns = 1024;
constexpr std::uint64_t kMaskSeed = 20250801;

}  // namespace

double px_per_mm(const View& view) {
  return view.camera.fx / view.camera.world_from_camera.translation().norm();
}

renderer::SphereLight sphere_light(const NearLight& light) {
  return {.center = light.position,
          .radius_mm = light.radius_mm,
          .radiance = light.intensity / (std::numbers::pi * light.radius_mm * light.radius_mm),
          .visible = false,
          .beam_axis = light.beam_axis,
          .beam_exponent = light.beam_exponent};
}

renderer::Scene view_scene(const WrappedSpool& spool, const renderer::ScatteringModel& scattering,
                           const NearLight& light) {
  return view_scene(spool, std::vector{aligned_threads(spool, scattering)}, light);
}

renderer::Scene view_scene(const WrappedSpool& spool, std::vector<renderer::CurveSet> threads, const NearLight& light) {
  renderer::Scene scene;
  scene.curves = std::move(threads);
  scene.meshes.push_back(holder_frame(spool, kFrameAlbedo));
  scene.lights.push_back(sphere_light(light));
  return scene;
}

cv::Mat1b thread_mask(const WrappedSpool& spool, const renderer::Camera& camera, const NearLight& light,
                      int samples_per_pixel) {
  const int factor = (camera.width + kMostColumns - 1) / kMostColumns;
  if (factor > 1) {
    cv::Mat1b mask;
    const renderer::Camera larger = renderer::with_larger_pixels(camera, factor);
    cv::resize(thread_mask(spool, larger, light, samples_per_pixel), mask, {}, factor, factor, cv::INTER_NEAREST);
    return mask(cv::Rect(0, 0, camera.width, camera.height)).clone();
  }
  // A white, rough thread scatters into every direction, so wherever a lit thread is seen the rendering is not zero.
  const renderer::FiberParameters white{.beta_m = 0.5, .beta_n = 0.5};
  const renderer::PathTracer tracer(view_scene(spool, white, light));
  renderer::RenderOptions options{.samples_per_pixel = samples_per_pixel, .seed = kMaskSeed};
  options.only = tracer.curve_coverage(camera, samples_per_pixel);
  const cv::Mat3f initial = tracer.render(camera, options);
  cv::Mat1b mask(initial.size(), 0);
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.cols; ++column) {
      const cv::Vec3f& pixel = initial(row, column);
      if (pixel[0] > 0 || pixel[1] > 0 || pixel[2] > 0) mask(row, column) = 255;
    }
  // Where light grazes the sheet, a few samples may all find shadow; holes smaller than this are not threads in the
  // dark.
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {kLargestHole_px, kLargestHole_px}));
  cv::bitwise_and(mask, options.only, mask);
  cv::erode(mask, mask, cv::getStructuringElement(cv::MORPH_RECT, {2 * kBorder_px + 1, 2 * kBorder_px + 1}));
  return mask;
}

Eigen::Vector3d diffuser_radiance(const NearLight& light) {
  const double beam = renderer::beam_factor(sphere_light(light), Eigen::Vector3d::Zero());
  return light.intensity * (beam / (std::numbers::pi * light.position.squaredNorm()));
}

}  // namespace inversion
