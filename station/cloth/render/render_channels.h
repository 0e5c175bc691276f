// A rendering as the channels of an EXR file. Beside R, G, B, with layers (renderer/trace/layers.h):
//
//   albedo.R albedo.G albedo.B   share of light that one scattering event sends on
//   normal.X normal.Y normal.Z   world
//   depth.Z                      mm along the camera's axis, 0 where there is nothing
//   cover.A                      share of the pixel in which a surface is seen first
//   thread.id                    1 + place in the scene's list of threads, 0 where there is none; whole numbers
//   yarn.id                      a number of its own for each yarn (packed_yarn), 0 where there is none; whole numbers
#pragma once

#include <vector>

#include "renderer/picture/image_file.h"
#include "renderer/trace/layers.h"
#include "station/cloth/render/build_scene.h"

namespace station {

// `layers`: none, or those of the same picture. `cloths`: those of the scene. With `half`, all but depth and ids are
// stored in 16 bit.
std::vector<renderer::ExrChannel> render_channels(const cv::Mat3f& image, const renderer::PictureLayers* layers,
                                                  const SceneFile& scene, const std::vector<BuiltCloth>& cloths,
                                                  bool half);

}  // namespace station
