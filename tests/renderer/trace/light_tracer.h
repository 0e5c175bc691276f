// A second estimator of what a camera sees of curves, which has no sampling strategy in common with PathTracer:
// particles start at the light, scatter by the adjoint of the scattering operator, and are connected with the camera's
// pinhole.
//
// In the scattering operator of round curves light leaves from where the *viewing* ray came in, straight through the
// curve: L(x, wo) = integral of f_cos(x; wo, wi) L(x, -wi) over all wi, for x on the surface with n . wo > 0, and back
// faces let light pass. So a particle that flies along -wi can be scattered at each surface that it enters (n . wi > 0)
// up to the first that it leaves, and there too (n . wi < 0); at each of them its weight changes by f_cos |n . wo| / |n
// . wi|. The last factor has no bound, so particles are split by their weight.
//
// A thread in which light wanders (ThreadExit::wandering) is met once, where a particle enters it: there the viewing
// ray leaves. The particle leaves where the viewing ray comes in; of other exits only the entry point is known here.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "renderer/picture/camera.h"
#include "renderer/scene/scene.h"

namespace renderer {

struct TracedLight {
  std::vector<Eigen::Array3d> mean;            // over the picture; [k]: from paths with up to k + 1 scattering vertices
  std::vector<Eigen::Array3d> standard_error;  // that of `mean`
};

// Traces particles in scenes of one set of curves near the plane z = 0, one sphere light of constant radiance, and a
// pinhole that looks along -z. Particles cross the plane of the scene's top within `aim_mm` of its middle (half width,
// half height).
TracedLight trace_light(const Scene& scene, const Camera& camera, const Eigen::Vector2d& aim_mm, int most_vertices,
                        std::int64_t particles, std::uint64_t seed);

}  // namespace renderer
