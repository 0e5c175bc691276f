// Fits a scattering model to photographs of a wrapped spool: minimises the loss of eq. 6 [Xia 2025]
//
//   L = sum over views i of  w_i sum over masked pixels ||I_i - I_ref,i||^2  +  penalties,      w_i = 1 / masked pixels
//
// over block averages (blocks.h), in units of the mean radiance of a perfect diffuser facing the lamp (view.h). The
// pictures I_i are path-traced. Penalties: scattering_family.h, and where the views say little the prior below.
//
//   solver              | light paths                                    | steps
//   levenberg_marquardt | recorded at the parameters known so far and    | until the loss settles, in each of a few rounds
//                       | shaded for all others (light_paths.h); each    | with more paths; bounds are kept
//                       | round records anew                             |
//   adam                | recorded anew for every step                   | 100, rate 0.01 [Xia 2025, section 4], clamped
//
// Eq. 6's hinges that keep energies positive are bounds here (thread_unknowns.h), for both solvers; its trend is rounded
// within a thousandth of its corner.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "inversion/certainty.h"
#include "inversion/scattering_family.h"
#include "inversion/thread_unknowns.h"
#include "inversion/view.h"

namespace inversion {

enum class ModelKind { thread, fiber, yarn };
enum class Solver { levenberg_marquardt, adam };

struct FitOptions {
  ModelKind model = ModelKind::thread;
  Solver solver = Solver::levenberg_marquardt;
  // Of the thread model; the baselines have starts of their own.
  renderer::ThreadParameters start = starting_thread();
  std::vector<renderer::ThreadParameters> other_starts = other_starting_threads();  // may be empty
  // One entry a round, at least one. Every start goes through all rounds but the last, which is for the one that has got
  // farthest. Adam goes from `start` alone, with as many paths a step as adam_paths says.
  std::vector<int> paths_per_block{256, 256, 512, 1024, 2048};
  int adam_steps = 100, adam_paths = 1024;
  // How strongly the thread model leans on simulated threads (renderer/scattering/thread_prior.h): 1 as their spread says,
  // beside data whose residuals are as large as those of the round before; 0: not at all. Levenberg-Marquardt only.
  double prior_weight = 1;
  // Levenberg-Marquardt ends with steps without the bias of the paths' noise (bias_free.h), unless the last of
  // paths_per_block is below 512. false: eq. 6 as it stands.
  bool without_bias = true;
  // Before its last round Levenberg-Marquardt weighs views and blocks by how far off they are (robust_weights.h). false: all
  // count as in eq. 6.
  bool robust = true;
  std::vector<ParameterGroup> held{};  // of the thread model: left at `start`, the only one then
  std::uint64_t seed = 1;
  // Called between steps with what is done and the finished fraction; returning false stops the fit.
  std::function<bool(const std::string&, double)> progress{};
};

// Levenberg-Marquardt from `start` alone, its first `rounds` alone (as many as there are when fewer).
FitOptions first_rounds(FitOptions options, std::size_t rounds);

struct FitRound {
  int paths_per_block = 0;
  int steps = 0;
  double loss_before = 0, loss_after = 0;
  std::vector<double> losses{};  // after each step, the loss before them first
  double prior_share = 0;        // of the loss that is the prior's
  bool bias_free = false;        // bias_free.h: the loss has no part of the paths' noise, and may be below zero
  bool converged = false;
};

struct ViewFit {
  renderer::ScatteringModel model;  // of a thread: with limit_energy on
  Eigen::VectorXd unknowns;
  std::vector<std::string> unknown_names;
  Certainty certainty;
  std::vector<FitRound> rounds;        // of the start that got farthest
  int start = 0;                       // 0: FitOptions::start, then other_starts
  std::vector<double> view_weights{};  // of each view, 0 ... 1: below 1 where it disagreed far more than the others
  int block_px = 0;
  std::size_t blocks = 0;

  const renderer::ThreadParameters& thread() const { return std::get<renderer::ThreadParameters>(model); }
  // Eq. 6's, by the last round that is not bias-free.
  double loss() const;
};

// Of yarns: the best of kYarnFiberCounts.
// Errors: std::runtime_error when the views are unusable (none, no masked pixels, dark lamp) or the fit was stopped;
// std::invalid_argument when there is no round or one without paths.
ViewFit fit_views(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options);

// Eq. 6's sum over the pictures, without penalties, at the fit's unknowns on light paths that no fit has seen: what two
// fits are compared by. Recorded `repetitions` >= 2 times.
struct IndependentLoss {
  double mean = 0, standard_error = 0;
  double without_noise = 0;  // by products of residuals of different repetitions: the misfit alone; may be below zero
};
IndependentLoss independent_loss(const WrappedSpool& spool, const std::vector<View>& views, const ViewFit& fit,
                                 int paths_per_block, int repetitions, std::uint64_t seed);

}  // namespace inversion
