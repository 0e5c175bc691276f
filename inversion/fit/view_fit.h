// What a fit to views is asked for (FitOptions) and what comes of it (ViewFit).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "inversion/fit/scattering_family.h"
#include "inversion/fit/thread_unknowns.h"
#include "inversion/solve/certainty.h"

namespace inversion {

enum class ModelKind { thread, fiber, yarn, paper, bundle };
enum class Solver { levenberg_marquardt, adam };

struct FitOptions {
  ModelKind model = ModelKind::thread;
  Solver solver = Solver::levenberg_marquardt;
  // The start of the thread model, with what a fit takes as given: the rule by which light leaves threads, and the
  // powers of the transmittance. The baselines have starts of their own.
  renderer::ThreadParameters start = starting_thread();
  std::vector<renderer::ThreadParameters> other_starts = other_starting_threads();  // may be empty
  // Whether the tint of the thread's highlight, lambda0_rgb, is unknown too, as metallic threads need it. The prior is
  // one of threads without and then does not count.
  bool tinted = false;
  // For ModelKind::paper, which heeds of the other options only the seed, adam_steps and, to say how certain it is,
  // adam_paths.
  int paths_per_pixel = 8;
  // Paths per block in each round, of which there is at least one. Every start goes through all rounds but the last,
  // which is for the one that gets nearest (start_choice.h). Adam goes from `start` alone, with adam_paths paths a
  // step.
  std::vector<int> paths_per_block{256, 256, 2048};
  int adam_steps = 100, adam_paths = 1024;
  // How strongly the thread model leans on simulated threads (renderer/scattering/thread_prior.h). At 1 their chi
  // square counts as that of residuals as large as those of the round before, in the steps without bias as that of the
  // mean of all paths; 0: not at all. It does not count in the first of several short rounds. Levenberg-Marquardt only.
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

// Between the seeds of a fit's traces, so that none shares the paths of another.
inline constexpr int kFitSeedStep = 1000003;

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

}  // namespace inversion
