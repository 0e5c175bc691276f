// A photographer's backdrop all around: a floor that bends upwards into a round wall, so that no edge, corner or
// horizon is seen behind what stands on it, from wherever one looks inside.
#pragma once

#include "renderer/scene/uv_mesh.h"

namespace renderer {

// The floor is a disc at z = 0 round the origin. It bends, over a quarter circle of radius `bend`, into a tube of
// radius `radius` that is open above, at z = height. The bright side is inside.
struct BackdropShape {
  double radius_mm = 4000, height_mm = 3000, bend_mm = 1500;
};

// Without uv. Errors: std::runtime_error, one line, when the bend is larger than floor or wall.
UvMesh backdrop_mesh(const BackdropShape& shape);

}  // namespace renderer
