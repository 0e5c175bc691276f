// Unbiased path tracing of a Scene: Embree for intersection, light sampling and scattering sampling combined by
// multiple importance sampling, Russian roulette. The picture depends on the seed only, never on the thread count.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>

#include "renderer/camera.h"
#include "renderer/film.h"
#include "renderer/layers.h"
#include "renderer/scene.h"

namespace renderer {

// What a rendering did.
struct RenderStatistics {
  std::uint64_t samples = 0;  // camera rays
  std::uint64_t rays = 0;     // nearest hits and shadows that were asked for, camera rays that meet no box left out
};

struct RenderOptions {
  int samples_per_pixel = 16;
  double noise = 0;  // above 0: each tile gets as many as bring its relative error (film.h) down to this, and no more
                     // than samples_per_pixel
  std::uint64_t seed = 1;
  int max_vertices =
      0;             // scattering vertices allowed (1 = direct light only); 0 = no limit, Russian roulette ends paths
  int threads = 0;   // 0 = all cores
  cv::Mat1b only{};  // when not empty: pixels that are 0 here are left black; height x width
  // Called now and then from the calling thread with the finished fraction; returning false stops the rendering.
  std::function<bool(double)> progress{};
  RenderStatistics* statistics = nullptr;  // when given: written at the end
};

// A scene committed to Embree, rendered as often as wanted.
class PathTracer {
 public:
  explicit PathTracer(Scene scene);
  ~PathTracer();
  PathTracer(PathTracer&&) noexcept;
  PathTracer& operator=(PathTracer&&) noexcept;

  // Mean radiance per pixel (RGB, box filter), height x width. Throws std::runtime_error when stopped by `progress`.
  cv::Mat3f render(const Camera& camera, const RenderOptions& options) const;

  // The same in passes over a film (empty_film() of the camera's size to begin with), which is good for a picture at
  // any time: goes on until the film has all samples, or returns false when stopped by `progress`. Called again with
  // the same scene, camera and options, it ends with the picture that render() gives, bit for bit. `statistics` are of
  // this call.
  bool refine(const Camera& camera, const RenderOptions& options, Film& film) const;

  // Of the first samples of such a rendering, at most 16 per pixel: far cheaper than its light.
  PictureLayers layers(const Camera& camera, const RenderOptions& options) const;

  SceneMemory memory() const;

  // 255 where a camera ray through the pixel (centre, or any of samples_per_pixel sub-positions) meets a curve first.
  cv::Mat1b curve_coverage(const Camera& camera, int samples_per_pixel) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace renderer
