// Fits the thread model to photographs of a wrapped spool: minimises the loss of eq. 6 [Xia 2025]
//
//   L = sum over views i of  w_i sum over masked pixels ||I_i - I_ref,i||^2  +  penalties,      w_i = 1 / masked pixels
//
// over block averages (blocks.h), in units of the mean radiance of a perfect diffuser facing the lamp (view.h), by
// Levenberg-Marquardt with bounds. The pictures I_i are path-traced: paths are recorded at the parameters known so far
// and shaded for all others (light_paths.h); each round records anew, with more paths. Penalties: lobes' energies whose
// sum exceeds 1 at some angle, and eq. 6's preference for lambda_0(1) <= lambda_0(0).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "inversion/thread_unknowns.h"
#include "inversion/view.h"

namespace inversion {

// A start that no thread is far from: grey, half rough, reflecting a third and passing a third of the light.
renderer::ThreadParameters starting_thread();
// The loss has local minima where the lobes have changed roles; others from which the search starts as well: clearer
// with lobes of like width, darker with a narrow reflection.
std::vector<renderer::ThreadParameters> other_starting_threads();

struct FitOptions {
  renderer::ThreadParameters start = starting_thread();
  std::vector<renderer::ThreadParameters> other_starts = other_starting_threads();  // may be empty
  // One entry a round, at least one. Every start goes through all rounds but the last, which is for the one that has got farthest.
  std::vector<int> paths_per_block{256, 256, 512, 1024, 2048};
  std::vector<ParameterGroup> held{};  // left at `start`, the only one then
  std::uint64_t seed = 1;
  // Called between steps with what is done and the finished fraction; returning false stops the fit.
  std::function<bool(const std::string&, double)> progress{};
};

struct FitRound {
  int paths_per_block = 0;
  int steps = 0;
  double loss_before = 0, loss_after = 0;
  bool converged = false;
};

struct ThreadFit {
  renderer::ThreadParameters parameters;  // with limit_energy on
  std::vector<FitRound> rounds;           // of the start that got farthest
  int start = 0;                          // 0: FitOptions::start, then other_starts
  int block_px = 0;
  std::size_t blocks = 0;
};

// Errors: std::runtime_error when the views are unusable (none, no masked pixels, dark lamp) or the fit was stopped;
// std::invalid_argument when there is no round or one without paths.
ThreadFit fit_thread(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options);

}  // namespace inversion
