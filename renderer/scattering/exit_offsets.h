// Where light leaves a thread in which it has wandered among fibers: the density of its offset out, given the offset at
// which it came in and the azimuth by which it turned, measured in multi-fiber simulations (MultiFiberScattering).
//
// An offset is the distance of a ray's line from the thread's axis in the cross-section, in thread radii, between -1
// and 1; it is positive where the axis lies to the right of the ray as it flies and the tangent points to the eye. What
// flies straight on keeps its offset. The azimuth is that of the direction in which light leaves, relative to the
// direction back to where it came from; 0: straight back.
//
// One table serves all threads: between fibers of 1/20 and 1/5 of the thread's radius, packed densely or loosely, of
// any textile's refractive index and at inclinations up to 60 degrees the densities differ by less than they differ
// from any simpler rule (exit_offsets_test.cpp prints by how much). The table is for light that is not absorbed;
// absorption favours short ways.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "renderer/scattering/thread_prior.h"

namespace renderer {

class ExitOffsets {
 public:
  // `share`: as MultiFiberScattering::exits, of any scale.
  ExitOffsets(int offset_bins, int azimuth_bins, const std::vector<double>& share);

  // The offset out for u in [0, 1).
  float sample(float offset_in, float azimuth, float u) const;
  // The density of `sample` per offset; its integral over -1..1 is 1.
  float density(float offset_in, float azimuth, float offset_out) const;

  int offset_bins() const { return offset_bins_; }
  int azimuth_bins() const { return azimuth_bins_; }

 private:
  // The bins of one offset in and one azimuth, for offsets in >= 0; `mirrored` where the true offset is negative.
  struct Row {
    const float* up_to;  // [i]: share of the bins up to and including i
    bool mirrored;
  };
  Row row(float offset_in, float azimuth) const;

  int offset_bins_, azimuth_bins_;
  std::vector<float> up_to_;
};

// The table that is built in (exit_offsets.json beside this file, made by `threadstation scatter exits`).
const ExitOffsets& simulated_exit_offsets();

// The threads of a library without absorption, each geometry once.
std::vector<LibraryThread> clear_threads(const std::vector<LibraryThread>& library);

struct ExitOptions {
  int rays = 4000, configurations = 100;  // per simulation
  int offset_bins = 16, azimuth_bins = 24;
  std::uint64_t seed = 1;
  std::function<bool(int done, int total)> progress{};  // returning false stops the work
};

// The mean of MultiFiberScattering::exits over threads that do not absorb, at inclinations of 0, 30 and 60 degrees.
// Errors: std::runtime_error when stopped by `progress`.
std::vector<double> mean_exits(const std::vector<LibraryThread>& threads, const ExitOptions& options);

}  // namespace renderer
