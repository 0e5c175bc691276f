// A motif's threads on a cloth of any shape: curves of the flat cloth (stitch_curves.h) carried to where its surface
// is.
#pragma once

#include <vector>

#include "renderer/scene/scene.h"

namespace renderer {

// Where a motif's frame lies in the cloth's: its origin in millimetres of ClothSurface::patch_mm, turned
// counter-clockwise.
struct MotifPlace {
  Eigen::Vector2d at_mm = Eigen::Vector2d::Zero();
  double turn_rad = 0;
  Eigen::Vector2d on_cloth(const Eigen::Vector2d& motif_mm) const;
};

// The middle of the part of the patch that the surface covers.
Eigen::Vector2d middle_of(const ClothSurface& surface);

// The curves of the flat cloth carried to the surface: their z = 0 becomes the surface raised by `height_mm` along its
// normals, and threads keep their thickness. Curves follow the surface from control point to control point; where it
// bends more than they are long, they cut its corners. Errors: std::runtime_error, one line, for a point that lies
// beside the cloth.
std::vector<CurveSet> sewn_curves(std::vector<CurveSet> flat, const MotifPlace& place, const ClothSurface& surface,
                                  double height_mm);

}  // namespace renderer
