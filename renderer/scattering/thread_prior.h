// What simulated threads have in common: mean and covariance of the thread model's colourless parameters over a library
// of multi-fiber simulations, for fits to photographs to lean on where their views say little.
//
// Unknowns, in this order: beta (3, roughness 0.02..1), then the energies of thread_energies.h (L0, L1, concavity, r1a,
// log r2a, log r2b, n2). Longitudinal roughness alpha is not among them: fibers are smooth in the simulation, so that
// it says nothing about alpha. Lobe centres are those of kThreadEta, as in the renderer.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "renderer/scattering/thread_energies.h"

namespace renderer {

inline constexpr int kPriorUnknownCount = 3 + kEnergyUnknownCount;
using PriorVector = Eigen::Matrix<double, kPriorUnknownCount, 1>;
using PriorMatrix = Eigen::Matrix<double, kPriorUnknownCount, kPriorUnknownCount>;

struct ThreadPrior {
  PriorVector mean = PriorVector::Zero();
  PriorMatrix covariance = PriorMatrix::Identity();
  int threads = 0;  // of the library
};

// The prior that is built in (thread_prior.json beside this file, made by `threadstation scatter prior`).
const ThreadPrior& simulated_thread_prior();

// A member of the library: fibers, and the absorptions of its three colours (per fiber radius).
struct LibraryThread {
  double radius_ratio, eta, gap;  // fiber radius / thread radius; index; gap in fiber radii
  std::array<double, 3> absorptions;
};
// Fibers of 1/20 to 1/5 of the thread's radius, indices from viscose to polyester, dense and loose; white, pale and
// strong in colour.
std::vector<LibraryThread> thread_library();

struct PriorOptions {
  int rays = 1000, configurations = 150, bins = 60;  // per simulation
  std::uint64_t seed = 1;
  std::function<bool(int done, int total)> progress{};  // false stops
};

struct LibraryFit {
  LibraryThread thread;
  PriorVector unknowns;
  double error;  // relative L2 of the joint fit over angles and colours
};

// Simulates and fits every thread of the library. Throws std::runtime_error when stopped.
std::vector<LibraryFit> fit_library(const std::vector<LibraryThread>& library, const PriorOptions& options);
ThreadPrior prior_of(const std::vector<LibraryFit>& fits);

}  // namespace renderer
