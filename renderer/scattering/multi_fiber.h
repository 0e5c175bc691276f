// Monte Carlo simulation of light in a thread of many smooth parallel fibers (Xia et al. 2025, section 3.2): parallel
// rays meet circles placed at random in a circle, are reflected and refracted at each, and are absorbed inside them.
//
// Every inclination theta is reduced exactly to the cross-section: translation along the fibers leaves theta unchanged,
// the plane's index is eta' = sqrt(eta^2 - sin^2 theta) / cos theta, Fresnel's reflectance is that of the angle in
// space, and a chord of the plane is 1 / cos theta_t longer in space [Marschner et al. 2003, with Fresnel as in Chiang
// et al. 2015]. Absorption acts inside fibers only. A ray that enters a fiber leaves it after k chords with probability
// (1 - F) F^(k-1), because all hits inside one circle have the same angle; position and direction follow in closed
// form, so that one visit of a fiber is one step. The authors' published program differs: it absorbs between fibers
// too, places centres uniformly in radius (here an option) and cuts rays off at 100 bounces (here faint rays are ended
// by Russian roulette, which is unbiased).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "renderer/scattering/fiber_bundle.h"

namespace renderer {

struct MultiFiberOptions {
  double thread_radius = 10, fiber_radius = 1, min_gap = 0.1;  // all three in the same unit
  int max_attempts = 1000;                                     // to place a fiber, per configuration
  FiberPlacement placement = FiberPlacement::area_uniform;
  double eta = 1.5;      // of the fibers, relative to the air around them
  double sigma_a = 0;    // per fiber radius
  double theta_rad = 0;  // inclination, |theta| < pi/2
  int rays = 4000;       // per configuration, spread evenly over the thread's width, each with a jitter
  int configurations = 1000;
  int bins = 180;
  int offset_bins = 0;  // of MultiFiberScattering::exits; 0: not counted
  std::uint64_t seed = 1;
  int threads = 0;  // 0 = all cores; the result does not depend on it
  // Called now and then from one thread with the finished fraction; returning false stops the simulation.
  std::function<bool(double)> progress{};
};

// What a simulation found. All fractions but `miss` are of the energy of the rays that met a fiber.
struct MultiFiberScattering {
  static constexpr int kRefractionBins = 16;

  // The energy that leaves, per radian: bin i covers -pi + [i, i+1] 2 pi / bins; phi = 0 is back towards the light. The
  // integral is the albedo.
  std::vector<double> density;
  std::vector<double> density_error;  // standard error from the scatter between configurations; 0 when there is one
  double miss = 0;                    // fraction of the rays that met no fiber
  double albedo = 0;
  double back = 0;          // part of the albedo with |phi| < pi/2
  double mean_fibers = 0;   // number of fibers, mean over the configurations
  double mean_entered = 0;  // fibers that a ray entered, each as often as it was entered
  double mean_length = 0;   // way inside fibers, in fiber radii
  // Entry i is the energy that left after 2 i refractions, the last with that of all longer ways. The sum is the
  // albedo.
  std::array<double, kRefractionBins> by_fibers_passed{};
  std::uint64_t rays = 0;  // rays that met a fiber

  // Where the energy leaves, as shares of the energy of all rays, those that met no fiber among them. A ray's offset is
  // the distance of its line from the thread's axis in thread radii, positive where the axis lies to its right, as it
  // flies; what flies straight on keeps it. Entry (in * bins + azimuth) * offset_bins + out holds what came in at
  // |offset| in [in, in + 1] / offset_bins and leaves within the bin of `density` and at an offset in -1 + [out, out +
  // 1] 2 / offset_bins. Rays that came in at a negative offset are counted as their mirror images.
  std::vector<double> exits;
};

// Errors: std::invalid_argument with one line for options out of range; std::runtime_error when stopped by progress.
MultiFiberScattering simulate_multi_fiber(const MultiFiberOptions& options);

// The centres of the fibers of one configuration (counted from 0) of such a simulation.
std::vector<Eigen::Vector2d> fiber_configuration(const MultiFiberOptions& options, int configuration);

}  // namespace renderer
