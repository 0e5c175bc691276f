// Directions of camera rays over one tile of a picture: the lens is inverted at pixel corners only and interpolated
// inside pixels, where its curvature is below 1e-4 pixel.
#pragma once

#include <vector>

#include "renderer/camera.h"
#include "renderer/sampler.h"

namespace renderer {

// Of a pixel among all, by rows: what its sampler is told apart by.
std::uint64_t pixel_number(const Camera& camera, int column, int row);

class PixelRays {
 public:
  // Pixels [column, column + width) x [row, row + height).
  PixelRays(const Camera& camera, int column, int row, int width, int height);
  // Ray through pixel (column, row) at offset u in [0, 1)^2 inside it; (0.5, 0.5) is its centre.
  CameraRay at(int column, int row, const Eigen::Vector2f& u) const;
  // A ray of the pixel's, from the pinhole or anywhere on the lens, by the sampler's next numbers.
  CameraRay sample(int column, int row, Sampler& sampler) const;

 private:
  int column_, row_, width_;
  Camera camera_;
  std::vector<Eigen::Vector3d> corners_;  // directions scaled to camera z = 1, row-major, (height + 1) x (width + 1)
};

}  // namespace renderer
