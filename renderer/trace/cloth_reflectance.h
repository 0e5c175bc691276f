// The BRDF of an endless flat cloth seen from afar, on black ground, by path tracing.
//
// Directions are unit vectors that point away from the cloth and lie above its face (z > 0); x is along the weft, y
// along the warp. The BRDF is radiance over irradiance, per steradian, RGB, averaged over the cloth's area as the
// viewer sees it, gaps included.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "renderer/trace/path_vertex.h"

namespace renderer {

class ClothReflectance {
 public:
  ClothReflectance(const YarnPatch& patch, const std::vector<ScatteringModel>& threads);

  // One unbiased sample of the BRDF for light from wi and a viewer at wo. It is not exactly reciprocal, because threads
  // are not.
  Eigen::Array3d sample(const Eigen::Vector3d& wi, const Eigen::Vector3d& wo, Sampler& sampler) const;

 private:
  Eigen::Array2d period_mm_;
  double above_mm_ = 0;  // a height above all yarns
  RayScene rays_;
  std::vector<CurveModel> models_;
};

// How much the BRDF changes when the cloth is turned under light and viewer: the root mean square of its deviation from
// the mean over all turns, relative to the root mean square of that mean. Both are taken over all channels and over
// pairs of directions that are drawn by cos theta and weighted with both cosines, as the light that is seen is. The
// noise of the estimates is no part of the result, because independent estimates are multiplied in pairs. Takes seconds
// on all cores; the same seed gives the same number.
double anisotropy(const ClothReflectance& cloth, std::uint64_t seed);

// An isotropic BRDF on the grid of the MERL database [Matusik et al. 2003]: 90 angles theta_h between the halfway
// vector and the normal, of which cell i covers (i/90)^2 to ((i+1)/90)^2 of a right angle; 90 angles theta_d between wi
// and the halfway vector; 180 azimuths phi_d of wi about the halfway vector from 0 to pi (phi_d + pi is light and
// viewer exchanged).
struct MerlGrid {
  static constexpr int kThetaH = 90, kThetaD = 90, kPhiD = 180, kCells = kThetaH * kThetaD * kPhiD;

  std::vector<Eigen::Array3d> brdf;  // [theta_h][theta_d][phi_d]; -1 below the horizon
  // Standard error of the cells over the BRDF, both as root mean squares weighted with both directions' cosines, as the
  // light that is seen is.
  double noise = 0;
  std::uint64_t samples = 0;

  static bool above_horizon(const Eigen::Array3d& value) { return value[0] >= 0; }
};

// Measures the mean BRDF over all turns of the cloth and both ways of the light. Every cell whose directions are both
// at least half a degree above the horizon gets samples of its own, and is then averaged with its neighbours by a
// triangle: three cells to each side in theta_h and theta_d and ten in phi_d, or more where cells are narrow. The
// averaging makes the noise small and loses detail finer than about three degrees. Uses all cores. `progress` is called
// now and then from any thread with the finished fraction; when it returns false the work ends by std::runtime_error.
MerlGrid measure_merl(const ClothReflectance& cloth, int samples_per_cell, std::uint64_t seed,
                      const std::function<bool(double)>& progress = {});

// The directions of light (wi) and viewer (wo) in the middle of a cell; one with z <= 0 is below the horizon.
struct MerlDirections {
  Eigen::Vector3d wi, wo;
};
MerlDirections merl_directions(int theta_h, int theta_d, int phi_d);

}  // namespace renderer
