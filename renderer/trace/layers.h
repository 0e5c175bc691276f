// Layers of a picture: what the camera rays of each pixel meet first, for denoising, for compositing, and to look a
// yarn up. Means are over those camera rays of a pixel that meet a surface.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "renderer/picture/camera.h"
#include "renderer/trace/path_vertex.h"
#include "renderer/trace/ray_scene.h"

namespace renderer {

struct PictureLayers {
  cv::Mat3f albedo;    // share of the light that one scattering event sends on, whatever the direction; RGB
  cv::Mat3f normal;    // of the surface, world x, y, z, towards its outside or the viewer; mean of unit vectors
  cv::Mat1f depth_mm;  // along the camera's axis; 0 where there is nothing
  cv::Mat1f cover;     // share of the camera rays that meet a surface
  // What most of the camera rays of the pixel meet; 0 where most meet nothing.
  cv::Mat1i model;  // 1 + number of the scattering model (scattering_models()); bodies that are no curves have none
  cv::Mat1i yarn;   // packed_yarn()
};

// The layers as features of denoising (picture/denoise.h).
std::vector<cv::Mat1f> features_of(const PictureLayers& layers);

// The yarn as one number that is never 0: bits 27 to 31 are the group, bit 26 is set for weft, and the bits below hold
// the yarn's number + 2^25. Groups from 32 on and yarns from 2^25 on are counted from the start again.
std::uint32_t packed_yarn(const YarnPlace& yarn);

// The layers by camera rays that are the first samples of a rendering with that seed (sampler.h). `models` are those of
// the scene; `threads` 0: all cores.
PictureLayers first_hit_layers(const RayScene& scene, const std::vector<CurveModel>& models, const Camera& camera,
                               int samples_per_pixel, std::uint64_t seed, int threads);

}  // namespace renderer
