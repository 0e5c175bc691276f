// The multi-fiber simulation as a first program would do it, to judge the results and the speed of the fast one: every
// segment of a ray tests every circle, every reflection inside a circle is traced, nothing is known about circles in
// advance.
#pragma once

#include "renderer/scattering/multi_fiber.h"

namespace renderer {

// Simulates as simulate_multi_fiber does, on one core; fills density, miss, albedo, back, mean_entered and rays.
MultiFiberScattering trace_circles_plainly(const MultiFiberOptions& options);

}  // namespace renderer
