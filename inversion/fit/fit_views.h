// The fit of a scattering model to photographs of a wrapped spool, which minimises the loss of eq. 6 [Xia 2025]
//
//   L = sum over views i of  w_i sum over masked pixels ||I_i - I_ref,i||^2  +  penalties,      w_i = 1 / masked pixels
//
// over block averages (blocks.h), in units of the mean radiance of a perfect diffuser facing the lamp (view.h). The
// pictures I_i are path-traced. Penalties: scattering_family.h, and where the views say little the prior below.
//
//   solver              | light paths                                 | steps
//   levenberg_marquardt | recorded at the parameters known so far and | until the loss settles, in each of a few rounds
//                       | shaded for all others (light_paths.h); each | with more paths; bounds are kept
//                       | round records anew                          |
//   adam                | recorded anew for every step                | 100, rate 0.01 [Xia 2025, section 4], clamped
//
// Eq. 6's hinges that keep energies positive are bounds here (thread_unknowns.h), for both solvers; its trend is
// rounded within a thousandth of its corner.
//
// ModelKind::bundle finds the number of fibers and their packing by short fits, then the fibers' scattering by
// Levenberg-Marquardt alone: it heeds neither `solver` nor `without_bias`.
//
// ModelKind::paper is the paper's own recipe, to tell what the model cannot do from what is done differently here:
// single pixels, all of the same weight in a view; the printed parameters with the printed hinges; light leaves where
// it came in; Adam from one start, 100 steps of rate 0.01; no prior, no robust weights. The paper gives neither the
// start nor the number of paths: they are this project's.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "inversion/fit/scattering_family.h"
#include "inversion/fit/thread_unknowns.h"
#include "inversion/solve/certainty.h"
#include "inversion/view/view.h"

namespace inversion {

enum class ModelKind { thread, fiber, yarn, paper, bundle };
enum class Solver { levenberg_marquardt, adam };

struct FitOptions {
  ModelKind model = ModelKind::thread;
  Solver solver = Solver::levenberg_marquardt;
  // The start of the thread model, with the rule by which light leaves threads; the baselines have starts of their own.
  renderer::ThreadParameters start = starting_thread();
  std::vector<renderer::ThreadParameters> other_starts = other_starting_threads();  // may be empty
  // For ModelKind::paper, which heeds of the other options only the seed, adam_steps and, to say how certain it is,
  // adam_paths.
  int paths_per_pixel = 8;
  // Paths per block in each round, of which there is at least one. Every start goes through all rounds but the last,
  // which is for the one that has got farthest. Adam goes from `start` alone, with adam_paths paths a step.
  std::vector<int> paths_per_block{256, 256, 512, 1024, 2048};
  int adam_steps = 100, adam_paths = 1024;
  // How strongly the thread model leans on simulated threads (renderer/scattering/thread_prior.h). At 1 their chi
  // square counts as that of residuals as large as those of the round before; 0: not at all. Levenberg-Marquardt only.
  double prior_weight = 1;
  // Whether Levenberg-Marquardt ends with steps without the bias of the paths' noise (bias_free.h), which it does not
  // when the last of paths_per_block is below 512. false: eq. 6 as it stands.
  bool without_bias = true;
  // Whether Levenberg-Marquardt, before its last round, weighs views and blocks by how far off they are
  // (robust_weights.h). false: all count as in eq. 6.
  bool robust = true;
  std::vector<ParameterGroup> held{};  // of the thread model: they stay as in `start`, then the only start
  std::uint64_t seed = 1;
  // Called between steps with what is done and the finished fraction; returning false stops the fit.
  std::function<bool(const std::string&, double)> progress{};
};

// The options for Levenberg-Marquardt from `start` alone with only the first `rounds` rounds (all, when there are
// fewer).
FitOptions first_rounds(FitOptions options, std::size_t rounds);

struct FitRound {
  int paths_per_block = 0;
  int steps = 0;
  double loss_before = 0, loss_after = 0;
  std::vector<double> losses{};  // after each step, the loss before them first
  double prior_share = 0;        // share of the loss that is the prior's
  bool bias_free = false;        // bias_free.h: the loss has no part of the paths' noise, and may be below zero
  bool converged = false;
};

struct ViewFit {
  ScatteringFamily family;
  renderer::ScatteringModel model;  // of a thread: with limit_energy on, but as fitted by the paper's recipe
  Eigen::VectorXd unknowns;
  std::vector<std::string> unknown_names;
  Certainty certainty;
  std::vector<FitRound> rounds;        // of the start that got farthest
  int start = 0;                       // 0: FitOptions::start, then other_starts
  std::vector<double> view_weights{};  // of each view, 0 ... 1: below 1 where it disagreed most
  int block_px = 0;
  std::size_t blocks = 0;

  const renderer::ThreadParameters& thread() const { return std::get<renderer::ThreadParameters>(model); }
  // The loss of eq. 6 by the last round that is not bias-free.
  double loss() const;
};

// The fit of a model to the views; of the yarn model the best of kYarnFiberCounts. Errors: std::runtime_error when the
// views are unusable (none, no masked pixels, dark lamp) or the fit was stopped; std::invalid_argument when there is no
// round or one without paths.
ViewFit fit_views(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options);

// The loss by which two fits are compared: eq. 6's sum over the pictures, without penalties, at the fit's unknowns, on
// light paths that no fit has seen. The paths are recorded `repetitions` >= 2 times.
struct IndependentLoss {
  double mean = 0, standard_error = 0;
  double without_noise = 0;  // by products of residuals of different repetitions: the misfit alone; may be below zero
};
IndependentLoss independent_loss(const WrappedSpool& spool, const std::vector<View>& views, const ViewFit& fit,
                                 int paths_per_block, int repetitions, std::uint64_t seed);

}  // namespace inversion
