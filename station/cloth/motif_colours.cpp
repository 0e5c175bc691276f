#include "station/cloth/motif_colours.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <utility>

#include "renderer/trace/path_tracer.h"
#include "renderer/trace/ray_scene.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

using Eigen::Array3d;

constexpr int kSteps = 5, kSamples = 12;
constexpr double kMostPixels = 100000;

// The camera with so many pixels at most.
renderer::Camera coarser(const renderer::Camera& camera) {
  const double pixels = static_cast<double>(camera.width) * camera.height;
  const int factor = static_cast<int>(std::ceil(std::sqrt(pixels / kMostPixels)));
  return factor > 1 ? renderer::with_larger_pixels(camera, factor) : camera;
}

// The thread that is seen in the middle of each pixel; -1: none.
cv::Mat1i threads_seen(const renderer::RayScene& rays, const renderer::Camera& camera,
                       const std::vector<std::size_t>& thread_of_set) {
  cv::Mat1i seen(camera.height, camera.width, -1);
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) {
      const renderer::CameraRay ray = renderer::ray_through(camera, column, row);
      const auto hit = rays.intersect({ray.origin.cast<float>(), ray.direction.cast<float>()});
      if (!hit) continue;
      if (const auto* curve = std::get_if<renderer::CurvePoint>(&hit->point))
        seen(row, column) = static_cast<int>(thread_of_set.at(curve->curve_set));
    }
  return seen;
}

std::vector<std::optional<Array3d>> means_of(const cv::Mat3f& picture, const cv::Mat1i& seen, std::size_t threads) {
  std::vector<Array3d> sums(threads, Array3d::Zero());
  std::vector<double> counts(threads, 0);
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column)
      if (const int thread = seen(row, column); thread >= 0) {
        const cv::Vec3f& value = picture(row, column);
        sums[static_cast<std::size_t>(thread)] += Array3d(value[0], value[1], value[2]);
        ++counts[static_cast<std::size_t>(thread)];
      }
  std::vector<std::optional<Array3d>> means(threads);
  for (std::size_t k = 0; k < threads; ++k)
    if (counts[k] > 0) means[k] = sums[k] / counts[k];
  return means;
}

// The wanted colour or, where a channel is as bright already as it can be, a darker one of the same hue.
Array3d reachable(const Array3d& wanted, const Array3d& seen, const Array3d& asked, const AbsorptionCurves& curves) {
  double part = 1;
  for (int c = 0; c < 3; ++c)
    if (asked[c] >= curves[static_cast<std::size_t>(c)].brightest() && seen[c] < wanted[c])
      part = std::min(part, seen[c] / wanted[c]);
  return part * wanted;
}

}  // namespace

MotifColours fit_motif_colours(const MotifColourRequest& request, const AbsorptionCurves& curves) {
  const renderer::Camera camera = coarser(request.camera);
  const std::size_t threads = request.threads.size();
  MotifColours fit{.threads = request.threads, .by_curve = {}, .seen = {}};
  std::vector<Array3d> asked(threads, Array3d::Zero());  // of the curves
  for (std::size_t k = 0; k < threads; ++k)
    if (request.wanted[k]) asked[k] = *request.wanted[k];
  cv::Mat1i regions;
  for (int step = 0; step <= kSteps; ++step) {
    renderer::Scene scene = request.scene(fit.threads);
    if (regions.empty()) regions = threads_seen(renderer::RayScene(scene), camera, request.thread_of_set);
    const renderer::PathTracer tracer(std::move(scene));
    const cv::Mat3f picture =
        tracer.render(camera, {.samples_per_pixel = kSamples, .seed = request.seed, .progress = [&](double share) {
                                 request.done((step + share) / (kSteps + 1));
                                 return !interrupted();
                               }});
    fit.seen = means_of(picture, regions, threads);
    if (step == 0) fit.by_curve = fit.seen;
    if (step == kSteps) break;
    for (std::size_t k = 0; k < threads; ++k) {
      if (!request.wanted[k] || !fit.seen[k]) continue;
      const Array3d target = reachable(*request.wanted[k], *fit.seen[k], asked[k], curves);
      for (int c = 0; c < 3; ++c) {
        const inversion::AbsorptionCurve& curve = curves[static_cast<std::size_t>(c)];
        // Beyond the ends of the curve nothing is gained, and the way back would be long.
        asked[k][c] = std::clamp(asked[k][c] + target[c] - (*fit.seen[k])[c], curve.darkest(), curve.brightest());
        fit.threads[k].sigma_a[c] = curve.sigma_a(asked[k][c]);
      }
    }
  }
  return fit;
}

}  // namespace station
