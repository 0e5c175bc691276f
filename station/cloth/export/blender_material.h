// A thread as a Cycles material (Principled Hair BSDF, Chiang's model), made by a Python script in Blender 3.4 or
// newer.
//
// The conventions are those of intern/cycles/kernel/closure/bsdf_hair_principled.h of Blender 3:
//   Cycles                 | here    | convention
//   Roughness              | beta_m  | Chiang's map to the variance, same as lobes.h; TT 1/4, TRT and the rest 4 times
//   Radial Roughness       | beta_n  | Chiang's map to the logistic scale, the same
//   Absorption Coefficient | sigma_a | per fiber radius: multiplied by a way through a fiber of radius 1
//   IOR                    | eta     |
//   Coat, Offset, Random   | 0       | otherwise R is narrower, lobes are tilted, strands differ
//
// The model takes the offset h from the curve's round surface, so the script sets the scene's curves to strands of
// shape `THICK` (3D curves; ribbons are flat). It also turns off Filter Glossy and clamping, which are on by default
// and change the picture.
#pragma once

#include <string>

#include "station/cloth/export/fiber_export.h"

namespace station {

// The text of the script.
std::string blender_material(const FiberExport& fiber);

}  // namespace station
