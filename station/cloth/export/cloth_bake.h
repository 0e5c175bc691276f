// The bake of one period of a cloth into textures, drawn by the two-scale renderer straight from above and from below:
// how much even light each texel sends back and lets through, how much of it yarns hide, and where their surfaces
// point.
#pragma once

#include <opencv2/core.hpp>

#include "station/cloth/export/cloth_sample.h"

namespace station {

// The textures of one side; picture up is the warp's +y. Colours are linear sRGB and means over the whole texel, holes
// and all.
struct BakedSide {
  cv::Mat3f reflectance;    // radiance for light of radiance 1 from all directions on the viewer's side
  cv::Mat3f transmittance;  // radiance for such light on the other side, without what holes let through
  cv::Mat1f opacity;        // share of the texel that yarns cover
  cv::Mat3f normal;         // unit: x to the right of the picture, y up, z to the viewer; (0, 0, 1) in holes
};

struct BakedCloth {
  double width_mm = 0, height_mm = 0;  // size of the period, which the picture shows whole
  BakedSide front, back;
};

struct BakeOptions {
  cv::Size size_px{256, 256};
  int samples_per_texel = 64;
  std::uint64_t seed = 1;
  PartProgress progress = [](double) { return true; };
};

// Bakes both sides. Errors: those of render_or_stop and surface_of.
BakedCloth bake_cloth(const ClothSample& cloth, const BakeOptions& options);

// The size in texels of about the same size both ways, `longer_side_px` of them along the longer side.
cv::Size bake_size(const ClothSample& cloth, int longer_side_px);
// The memory that a bake of that size, and all that is made of it, takes at most, in bytes.
double bake_bytes(const cv::Size& size_px);

}  // namespace station
