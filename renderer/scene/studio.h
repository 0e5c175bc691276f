// What stands in a studio besides the garments: a photographer's backdrop, and a dress form. Both are turned round the
// z axis and have no uv.
#pragma once

#include "renderer/scene/uv_mesh.h"

namespace renderer {

// A floor that bends upwards into a round wall, so that no edge, corner or horizon is seen behind what stands on it,
// from wherever one looks inside. The floor is a disc at z = 0 round the origin. It bends, over a quarter circle of
// radius `bend`, into a tube of radius `radius` that is open above, at z = height. The bright side is inside.
struct BackdropShape {
  double radius_mm = 4000, height_mm = 3000, bend_mm = 1500;
};

// Errors: std::runtime_error, one line, when the bend is larger than floor or wall.
UvMesh backdrop_mesh(const BackdropShape& shape);

// What a skirt hangs on, so that no light comes down through its waist: a round column from z = 0, open below, that
// ends above in a flat dome, a fifth as high as wide, at z = height. The face is outside.
struct FormShape {
  double radius_mm = 95, height_mm = 590;
};

UvMesh form_mesh(const FormShape& shape);

}  // namespace renderer
