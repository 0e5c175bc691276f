// A thread as the `hair` BSDF of Mitsuba 3, in a scene file of its own for <include>.
//
// The conventions are those of src/bsdfs/hair.cpp of Mitsuba 3:
//   Mitsuba                | here    | convention
//   longitudinal_roughness | beta_m  | Chiang's map to the variance, same as lobes.h; TT 1/4, TRT and the rest 4 times
//   azimuthal_roughness    | beta_n  | Chiang's map to the logistic scale, the same
//   sigma_a, scale         | sigma_a | per fiber radius: multiplied by a way through a fiber of radius 1 (the manual
//                          |         | says inverse scene units). RGB values must be 0 to 1: `scale` has what is above
//   int_ior, ext_ior       | eta, 1  | ext_ior would be that of air otherwise
//   scale_tilt             | 0       | degrees; 2 otherwise
//
// The BSDF is made for `bsplinecurve` shapes of any unit and radius.
#pragma once

#include <string>

#include "station/cloth/export/fiber_export.h"

namespace station {

// The text of the file.
std::string mitsuba_scene(const FiberExport& fiber);

}  // namespace station
