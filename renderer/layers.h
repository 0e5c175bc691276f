// What the pixels of a picture show first, beside the light from there: for denoising, for compositing, and to look a
// yarn up. Means are over those camera rays of a pixel that meet a surface.
#pragma once

#include <opencv2/core.hpp>

#include "renderer/camera.h"
#include "renderer/path_vertex.h"
#include "renderer/ray_scene.h"

namespace renderer {

struct PictureLayers {
  cv::Mat3f albedo;    // share of the light that one scattering event sends on, whatever the direction; RGB
  cv::Mat3f normal;    // of the surface, towards its outside or the viewer: world x, y, z; the mean of unit vectors
  cv::Mat1f depth_mm;  // along the camera's axis; 0 where there is nothing
  cv::Mat1f cover;     // share of the camera rays
  // What most of the camera rays meet; 0 where that is nothing.
  cv::Mat1i model;  // 1 + number of the scattering model (scattering_models()); bodies that are no curves have none
  cv::Mat1i yarn;   // packed_yarn()
};

// As one number that is never 0: bits 27-31 the group, bit 26 set for weft, below it the yarn's number + 2^25. Groups
// and yarns beyond 32 and 2^25 begin again.
std::uint32_t packed_yarn(const YarnPlace& yarn);

// The camera rays are the first samples of a rendering with that seed (sampler.h). `models` are those of the scene.
PictureLayers first_hit_layers(const RayScene& scene, const std::vector<CurveModel>& models, const Camera& camera,
                               int samples_per_pixel, std::uint64_t seed, int threads);

}  // namespace renderer
