// Scattering of one dielectric fiber (Chiang et al. 2015): lobes R, TT, TRT and the remainder.
// [the owner of this file completes the documentation; see models.md 1.1-1.6]
#pragma once

#include <Eigen/Core>

namespace renderer {

struct FiberParameters {
  double eta = 1.55;                                      // relative index of refraction
  Eigen::Vector3d sigma_a = Eigen::Vector3d::Zero();      // absorption per fiber radius, RGB
  double beta_m = 0.3;                                    // longitudinal roughness, 0.02..1
  double beta_n = 0.3;                                    // azimuthal roughness, 0.02..1
  double tilt_rad = 0.0;                                  // cuticle tilt
};

}  // namespace renderer
