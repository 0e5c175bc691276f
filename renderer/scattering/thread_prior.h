// The prior of fits to photographs: what simulated threads have in common, as mean and covariance of the thread model's
// colourless parameters over a library of multi-fiber simulations. Fits lean on it where their views say little.
//
// Unknowns, in this order: beta (3, roughness 0.02..1), then the energies of thread_energies.h (L0, L1, concavity, r1a,
// d2, w2, n2). Longitudinal roughness alpha is not among them: the simulated fibers are smooth, so that the
// simulation says nothing about it. Lobe centres are those of kThreadEta, as in the renderer.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "renderer/scattering/multi_fiber.h"
#include "renderer/scattering/thread_energies.h"

namespace renderer {

inline constexpr int kPriorUnknownCount = 3 + kEnergyUnknownCount;
using PriorVector = Eigen::Matrix<double, kPriorUnknownCount, 1>;
using PriorMatrix = Eigen::Matrix<double, kPriorUnknownCount, kPriorUnknownCount>;

struct ThreadPrior {
  PriorVector mean = PriorVector::Zero();
  PriorMatrix covariance = PriorMatrix::Identity();
  int threads = 0;  // number of threads in the library
};

// The prior that is built in (thread_prior.json beside this file, made by `threadstation scatter prior`).
const ThreadPrior& simulated_thread_prior();

// A thread of the library: its fibers, and the absorptions of its three colours (per fiber radius).
struct LibraryThread {
  double radius_ratio, eta, gap;  // fiber radius / thread radius; refractive index; gap in fiber radii
  std::array<double, 3> absorptions;
};
// The library: fibers of 1/20 to 1/5 of the thread's radius, refractive indices from viscose's to polyester's, packed
// densely and loosely; each thread white, pale and strong in colour.
std::vector<LibraryThread> thread_library();
// The simulation of such a thread with fibers that absorb `sigma_a` per radius, at inclination `theta_rad`; rays,
// configurations, bins and seed are left to the caller.
MultiFiberOptions simulation_of(const LibraryThread& thread, double sigma_a, double theta_rad);

struct PriorOptions {
  int rays = 1000, configurations = 150, bins = 60;  // per simulation
  std::uint64_t seed = 1;
  std::function<bool(int done, int total)> progress{};  // returning false stops the work
};

struct LibraryFit {
  LibraryThread thread;
  PriorVector unknowns = PriorVector::Zero();
  PriorMatrix covariance = PriorMatrix::Zero();  // of the unknowns, AzimuthalFit::covariance
  double error = 0;                              // relative L2 of the joint fit over angles and colours
};

// Simulates and fits every thread of the library. Errors: std::runtime_error when stopped by `progress`.
std::vector<LibraryFit> fit_library(const std::vector<LibraryThread>& library, const PriorOptions& options);
// The prior that these fits give: mean of their unknowns, and the covariance by the law of total variance, that among
// the threads plus the mean of each fit's own. By the first alone the prior is surer of what three dozen fits share
// than any of them is: w2 was .98 +- .03, where a fit tells it to .1 from one inclination to the other.
ThreadPrior prior_of(const std::vector<LibraryFit>& fits);

}  // namespace renderer
