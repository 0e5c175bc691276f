// Unbiased path tracing of a Scene: Embree finds intersections, sampling of lights and of scattering are combined by
// multiple importance sampling, and Russian roulette ends paths. The picture depends on the seed only, never on the
// thread count.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>

#include "renderer/picture/camera.h"
#include "renderer/picture/film.h"
#include "renderer/picture/tile_share.h"
#include "renderer/scene/scene.h"
#include "renderer/trace/layers.h"

namespace renderer {

// What a rendering did.
struct RenderStatistics {
  std::uint64_t samples = 0;  // camera rays
  std::uint64_t rays = 0;     // traced for nearest hits and shadows, without camera rays that miss the scene's box
};

// What is to be done after a pass over the tiles.
enum class PassEnd { next, finished, stopped };

struct RenderOptions {
  int samples_per_pixel = 16;
  double noise = 0;  // above 0: a tile gets only the samples that bring its relative error (film.h) down to this
  std::uint64_t seed = 1;
  int max_vertices = 0;  // most scattering vertices of a path (1: direct light only); 0: no limit but Russian roulette
  int threads = 0;       // 0 = all cores
  cv::Mat1b only{};      // when not empty: pixels that are 0 here are left black; height x width
  // Called now and then from the calling thread with the finished fraction; returning false stops the rendering.
  std::function<bool(double)> progress{};
  RenderStatistics* statistics = nullptr;  // when given: written at the end
  TileShare share{};                       // refine draws these tiles alone
  // Called at the end of each pass in place of raise_goals (film.h), where others draw the other shares: it sets the
  // goals of the next pass, or says that all have finished, or that this rendering is to stop.
  std::function<PassEnd(Film&)> end_pass{};
};

// A scene committed to Embree, rendered as often as wanted.
class PathTracer {
 public:
  explicit PathTracer(Scene scene);
  ~PathTracer();
  PathTracer(PathTracer&&) noexcept;
  PathTracer& operator=(PathTracer&&) noexcept;

  // The mean radiance per pixel (RGB, box filter), height x width. Errors: std::runtime_error when stopped by
  // `progress`, or when `only` has another size.
  cv::Mat3f render(const Camera& camera, const RenderOptions& options) const;

  // Renders in passes over a film, which is empty_film() of the camera's size to begin with and holds a usable picture
  // at any time. Returns true when the film (its share, see RenderOptions) has all samples, false when stopped by
  // `progress` or `end_pass`. Called again with the
  // same scene, camera and options, it ends with the picture that render() gives, bit for bit. `statistics` count this
  // call alone. Errors: std::runtime_error when the film or `only` has another size.
  bool refine(const Camera& camera, const RenderOptions& options, Film& film) const;

  // The layers of the first samples of such a rendering, at most 16 per pixel; they cost far less than its light.
  PictureLayers layers(const Camera& camera, const RenderOptions& options) const;

  SceneMemory memory() const;

  // A mask, 255 where a camera ray through the pixel (through its centre, or any of samples_per_pixel sub-positions)
  // meets a curve first.
  cv::Mat1b curve_coverage(const Camera& camera, int samples_per_pixel) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace renderer
