// Monte Carlo simulation of light in a thread of many smooth parallel fibers (Xia et al. 2025, section 3.2): parallel
// rays meet circles placed at random in a circle, are reflected and refracted at each, and are absorbed inside them.
//
// Any inclination theta by the exact reduction to the cross-section: translation along the fibers leaves theta
// unchanged, the plane's index is eta' = sqrt(eta^2 - sin^2 theta) / cos theta, Fresnel's reflectance is that of the
// angle in space, and a chord of the plane is 1 / cos theta_t longer in space [Marschner et al. 2003, with Fresnel as in
// Chiang et al. 2015]. Absorption acts inside fibers only. A fiber that a ray enters is left after k chords with
// probability (1 - F) F^(k-1), because all hits inside one circle have the same angle: position and direction follow
// in closed form, so one visit of a fiber is one step. Deviations from the authors' published program, which absorbs
// between fibers too, places centres uniformly in radius (here an option) and cuts rays off at 100 bounces (here
// Russian roulette of faint rays, unbiased).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "renderer/fiber_bundle.h"

namespace renderer {

struct MultiFiberOptions {
  double thread_radius = 10, fiber_radius = 1, min_gap = 0.1;  // in one unit, whichever
  int max_attempts = 1000;                                     // to place a fiber, per configuration
  FiberPlacement placement = FiberPlacement::area_uniform;
  double eta = 1.5;      // of the fibers, relative to the air around them
  double sigma_a = 0;    // per fiber radius
  double theta_rad = 0;  // inclination, |theta| < pi/2
  int rays = 4000;       // per configuration, spread evenly over the thread's width with a jitter each
  int configurations = 1000;
  int bins = 180;
  std::uint64_t seed = 1;
  int threads = 0;  // 0 = all cores; the result does not depend on it
  // Called now and then from one thread with the finished fraction; returning false stops the simulation.
  std::function<bool(double)> progress{};
};

// All fractions are of the energy of the rays that met a fiber, except `miss`.
struct MultiFiberScattering {
  static constexpr int kRefractionBins = 16;

  // Energy leaving per radian; bin i covers -pi + [i, i+1] 2 pi / bins; phi = 0 is back towards the light. Its integral
  // is the albedo.
  std::vector<double> density;
  std::vector<double> density_error;  // standard error from the scatter between configurations; 0 when there is one
  double miss = 0;                    // fraction of the rays that met no fiber
  double albedo = 0;
  double back = 0;          // part of the albedo with |phi| < pi/2
  double mean_fibers = 0;   // in a configuration
  double mean_entered = 0;  // fibers a ray entered (again counted again)
  double mean_length = 0;   // way inside fibers, in fiber radii
  // Energy that left after 2 i refractions, the last with all longer ways. Sums to the albedo.
  std::array<double, kRefractionBins> by_fibers_passed{};
  std::uint64_t rays = 0;  // that met a fiber
};

// Errors: std::invalid_argument with one line for options out of range; std::runtime_error when stopped by progress.
MultiFiberScattering simulate_multi_fiber(const MultiFiberOptions& options);

// Centres of the fibers of one configuration (0-based) of such a simulation.
std::vector<Eigen::Vector2d> fiber_configuration(const MultiFiberOptions& options, int configuration);

}  // namespace renderer
