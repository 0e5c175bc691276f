#include "inversion/fit/levenberg_rounds.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "inversion/fit/loss_terms.h"
#include "inversion/fit/step_coordinates.h"

namespace inversion {
namespace {

using Eigen::VectorXd;

constexpr int kMostSteps = 40;
constexpr int kMostReweighings = 4;
constexpr double kSettledWeight = 0.1;
constexpr double kTracingShare = 0.4;  // of a round's work

struct FollowLoss : ceres::IterationCallback {
  std::function<bool(int)> go_on;
  std::vector<double>* losses = nullptr;
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    losses->push_back(step.cost);
    return go_on(step.iteration) ? ceres::SOLVER_CONTINUE : ceres::SOLVER_ABORT;
  }
};

void set_bounds(ceres::Problem& problem, const Search& search, VectorXd& unknowns) {
  const auto count = static_cast<int>(unknowns.size());
  for (int k = 0; k < count; ++k) {
    problem.SetParameterLowerBound(unknowns.data(), k, search.unknowns.lower[k]);
    problem.SetParameterUpperBound(unknowns.data(), k, search.unknowns.upper[k]);
  }
  if (static_cast<int>(search.held.size()) == count)
    problem.SetParameterBlockConstant(unknowns.data());
  else
    problem.SetManifold(unknowns.data(), new StepManifold(StepCoordinates(search.unknowns), count, search.held));
}

FitRound solve(const ViewObjective& objective, const Search& search, double prior_scale,
               const std::function<bool(int)>& go_on, VectorXd& unknowns) {
  ceres::Problem problem;
  problem.AddResidualBlock(new DataTerm(objective, static_cast<int>(unknowns.size())), nullptr, unknowns.data());
  add_penalties(*search.family, problem, unknowns.data());
  const ThreadPriorTerm prior(prior_scale);
  if (prior_scale > 0) prior.add_to(problem, unknowns.data());
  set_bounds(problem, search, unknowns);

  FitRound round;
  FollowLoss callback;
  callback.go_on = go_on;
  callback.losses = &round.losses;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = kMostSteps;
  options.function_tolerance = 1e-6;
  options.initial_trust_region_radius = 1;  // the start is far: full Gauss-Newton steps end at the bounds
  options.logging_type = ceres::SILENT;
  options.callbacks = {&callback};
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.termination_type == ceres::USER_FAILURE) throw_stopped();
  if (!summary.IsSolutionUsable())
    throw std::runtime_error("the fit found no thread: " + summary.message + "; look at the views and their masks");
  round.steps = static_cast<int>(summary.iterations.size()) - 1;
  round.loss_before = summary.initial_cost, round.loss_after = summary.final_cost;
  if (prior_scale > 0) round.prior_share = prior.loss(unknowns) / std::max(round.loss_after, 1e-300);
  round.converged = summary.termination_type == ceres::CONVERGENCE;
  return round;
}

// The prior's chi square counts as much as that of residuals of the size that the round before left.
double prior_scale(const ViewObjective& objective, const Search& search, const std::vector<FitRound>& before) {
  if (!search.has_prior()) return 0;
  const auto last =
      std::find_if(before.rbegin(), before.rend(), [](const FitRound& round) { return !round.bias_free; });
  if (last == before.rend()) return 0;
  return search.options->prior_weight * 2 * last->loss_after / objective.residual_count();
}

}  // namespace

void run_round(ViewObjective& objective, const Search& search, int round, bool robustly, Work& work, Attempt& attempt) {
  const FitOptions& options = *search.options;
  const int paths = options.paths_per_block[static_cast<std::size_t>(round)];
  const std::string name = "start " + std::to_string(attempt.start + 1) + ", round " + std::to_string(round + 1) +
                           " of " + std::to_string(options.paths_per_block.size());
  if (!attempt.rounds.empty()) lighten_blackest(search, attempt.unknowns);
  // Every start gets the same seed, because the starts' losses are compared: pixels and random numbers are alike,
  // though the paths part where they are traced with other parameters.
  objective.trace(attempt.unknowns, paths, seed_of_trace(options, round),
                  [&](int done, int total) { work.show(name + ", tracing", kTracingShare * paths * done / total); });
  // The prior counts from the last short round on. If that is the first, it counts as much as the paths' noise: what
  // they say nothing of stays near the prior.
  const bool last_short = round + 2 == std::ssize(options.paths_per_block);
  const double first_scale = last_short && search.has_prior()
                                 ? options.prior_weight * objective.residual_variances(attempt.unknowns).mean()
                                 : 0;
  const auto search_on = [&] {
    attempt.prior_scale = attempt.rounds.empty() ? first_scale : prior_scale(objective, search, attempt.rounds);
    return solve(
        objective, search, attempt.prior_scale,
        [&](int step) {
          const double share = kTracingShare + (1 - kTracingShare) * step / kMostSteps;
          return work.goes_on(name + ", step " + std::to_string(step), share * paths);
        },
        attempt.unknowns);
  };
  if (robustly) attempt.view_weights = objective.weigh_robustly(attempt.unknowns);
  attempt.rounds.push_back(search_on());
  // A single round has no other whose loss says what the prior counts.
  if (options.paths_per_block.size() == 1 && search.has_prior()) attempt.rounds.back() = search_on();
  // A bad view has pulled the fit towards itself before it is told from the others: as it loses weight, it stands out
  // more.
  for (int again = 0; robustly && again < kMostReweighings; ++again) {
    std::vector<double> weights = objective.weigh_robustly(attempt.unknowns);
    const bool settled = std::equal(weights.begin(), weights.end(), attempt.view_weights.begin(),
                                    [](double x, double y) { return std::abs(x - y) < kSettledWeight; });
    attempt.view_weights = std::move(weights);
    if (settled) break;
    attempt.rounds.back() = search_on();
  }
  attempt.rounds.back().paths_per_block = paths;
  work.finish(paths);
}

}  // namespace inversion
