#include "inversion/fit_thread.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <stdexcept>

#include "inversion/thread_objective.h"

namespace inversion {
namespace {

using renderer::kThreadParameterCount;

constexpr double kGamma = 1e-4;          // of eq. 6's trend of lambda_0
constexpr double kTrendRounding = 1e-3;  // below this the hinge is rounded, so that it has a derivative
constexpr int kEnergyAngles = 33;        // c = 0, where no view sees how high lambda_2 rises, to c = 1
// Of the mean squared excess: 1 % of it costs as much as a tenth of the data term.
constexpr double kEnergyPenalty = 30;
constexpr int kMostSteps = 40;
constexpr const char* kStopped = "the fit was stopped on request; start it again for a thread";

class DataTerm : public ceres::CostFunction {
 public:
  explicit DataTerm(const ThreadObjective& objective) : objective_(objective) {
    set_num_residuals(objective.residual_count());
    mutable_parameter_block_sizes()->push_back(kThreadParameterCount);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    objective_.residuals(Eigen::Map<const ThreadUnknowns>(parameters[0]), residuals,
                         jacobians ? jacobians[0] : nullptr);
    return true;
  }

 private:
  const ThreadObjective& objective_;
};

// Energy beyond 1 at evenly spaced c, both ends included: it is there that fits exceed it first.
struct EnergyTerm {
  template <class S>
  bool operator()(const S* u, S* residuals) const {
    renderer::BasicThreadParameters<S> p;
    renderer::set_energies(u + kL0, p);
    p.limit_energy = false;
    const double weight = std::sqrt(2 * kEnergyPenalty / kEnergyAngles);
    for (int i = 0; i < kEnergyAngles; ++i) {
      const double c = i / (kEnergyAngles - 1.0);
      const auto lambda = renderer::thread_lobe_energies<S>(p, c);
      const S excess = lambda[0] + lambda[1] + lambda[2] - S(1.0);
      residuals[i] = excess > S(0.0) ? S(weight) * excess : S(0.0);
    }
    return true;
  }
};

// lambda_0(1) - lambda_0(0) where positive.
struct TrendTerm {
  template <class S>
  bool operator()(const S* u, S* residual) const {
    residual[0] = u[kL1] > u[kL0] ? u[kL1] - u[kL0] : S(0.0);
    return true;
  }
};

struct StopOnRequest : ceres::IterationCallback {
  std::function<bool(int)> go_on;
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    return go_on(step.iteration) ? ceres::SOLVER_CONTINUE : ceres::SOLVER_ABORT;
  }
};

void set_bounds(ceres::Problem& problem, ThreadUnknowns& unknowns, const std::vector<ParameterGroup>& held) {
  const ThreadUnknowns low = lower_bounds(), high = upper_bounds();
  std::vector<int> constant;
  for (int k = 0; k < kThreadParameterCount; ++k) {
    problem.SetParameterLowerBound(unknowns.data(), k, low[k]);
    problem.SetParameterUpperBound(unknowns.data(), k, high[k]);
    if (std::find(held.begin(), held.end(), group_of(k)) != held.end()) constant.push_back(k);
  }
  if (static_cast<int>(constant.size()) == kThreadParameterCount)
    problem.SetParameterBlockConstant(unknowns.data());
  else if (!constant.empty())
    problem.SetManifold(unknowns.data(), new ceres::SubsetManifold(kThreadParameterCount, constant));
}

FitRound solve(const ThreadObjective& objective, const std::vector<ParameterGroup>& held,
               const std::function<bool(int)>& go_on, ThreadUnknowns& unknowns) {
  ceres::Problem problem;
  problem.AddResidualBlock(new DataTerm(objective), nullptr, unknowns.data());
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<EnergyTerm, kEnergyAngles, kThreadParameterCount>(new EnergyTerm), nullptr,
      unknowns.data());
  // Huber's loss is linear beyond the rounding: half of it times the scale is gamma |x|.
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<TrendTerm, 1, kThreadParameterCount>(new TrendTerm),
      new ceres::ScaledLoss(new ceres::HuberLoss(kTrendRounding), kGamma / kTrendRounding, ceres::TAKE_OWNERSHIP),
      unknowns.data());
  set_bounds(problem, unknowns, held);

  StopOnRequest callback;
  callback.go_on = go_on;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = kMostSteps;
  options.function_tolerance = 1e-4;
  options.initial_trust_region_radius = 1;  // the start is far: full Gauss-Newton steps end at the bounds
  options.logging_type = ceres::SILENT;
  options.callbacks = {&callback};
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.termination_type == ceres::USER_FAILURE) throw std::runtime_error(kStopped);
  if (!summary.IsSolutionUsable())
    throw std::runtime_error("the fit found no thread: " + summary.message + "; look at the views and their masks");
  return {.steps = static_cast<int>(summary.iterations.size()) - 1,
          .loss_before = summary.initial_cost,
          .loss_after = summary.final_cost,
          .converged = summary.termination_type == ceres::CONVERGENCE};
}

// One search from one start, round after round.
struct Search {
  int start = 0;
  ThreadUnknowns unknowns;
  std::vector<FitRound> rounds{};
  double loss() const { return rounds.empty() ? 0 : rounds.back().loss_after; }
};

class RoundRunner {
 public:
  RoundRunner(ThreadObjective& objective, const FitOptions& options, std::size_t starts)
      : objective_(objective), options_(options) {
    const std::vector<int>& paths = options.paths_per_block;
    for (std::size_t round = 0; round < paths.size(); ++round)
      whole_ += paths[round] * (round + 1 < paths.size() ? static_cast<double>(starts) : 1.0);
  }

  void run(Search& search, std::size_t round) {
    constexpr double kTracingShare = 0.4;
    const int paths = options_.paths_per_block[round];
    const std::string name = "start " + std::to_string(search.start + 1) + ", round " + std::to_string(round + 1) +
                             " of " + std::to_string(options_.paths_per_block.size());
    const auto go_on = [&](const std::string& what, double share) {
      return !options_.progress || options_.progress(name + ", " + what, (done_ + share * paths) / whole_);
    };
    // The same seed for every start, whose losses are compared: pixels and random numbers alike, though the paths part
    // where they are traced with other parameters.
    objective_.trace(parameters_of(search.unknowns), paths, options_.seed + 1000003 * round,
                     [&](int views_done, int total) {
                       if (!go_on("tracing", kTracingShare * views_done / total)) throw std::runtime_error(kStopped);
                     });
    search.rounds.push_back(solve(
        objective_, options_.held,
        [&](int step) {
          return go_on("step " + std::to_string(step), kTracingShare + (1 - kTracingShare) * step / kMostSteps);
        },
        search.unknowns));
    search.rounds.back().paths_per_block = paths;
    done_ += paths;
  }

 private:
  ThreadObjective& objective_;
  const FitOptions& options_;
  double whole_ = 0, done_ = 0;
};

}  // namespace

renderer::ThreadParameters starting_thread() {
  renderer::ThreadParameters p;
  p.sigma_a.setConstant(0.3);
  return p;
}

std::vector<renderer::ThreadParameters> other_starting_threads() {
  renderer::ThreadParameters clear = starting_thread(), dark = starting_thread();
  clear.sigma_a.setConstant(0.1);
  clear.alpha = {0.4, 0.3, 0.3};
  clear.beta = {0.9, 0.6, 0.6};
  dark.sigma_a.setConstant(0.6);
  dark.alpha = {0.15, 0.3, 0.8};
  dark.beta = {0.9, 0.6, 0.3};
  return {clear, dark};
}

ThreadFit fit_thread(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options) {
  const std::vector<int>& paths = options.paths_per_block;
  if (paths.empty() || *std::min_element(paths.begin(), paths.end()) < 1)
    throw std::invalid_argument("a fit was asked for without rounds or with a round without light paths");
  ThreadObjective objective(spool, views);
  std::vector<Search> searches{{.start = 0, .unknowns = unknowns_of(options.start)}};
  if (options.held.empty())
    for (const renderer::ThreadParameters& start : options.other_starts)
      searches.push_back({.start = static_cast<int>(searches.size()), .unknowns = unknowns_of(start)});
  RoundRunner runner(objective, options, searches.size());
  const std::size_t last = paths.size() - 1;
  for (Search& search : searches)
    for (std::size_t round = 0; round < last; ++round) runner.run(search, round);
  Search& best = *std::min_element(searches.begin(), searches.end(),
                                   [](const Search& a, const Search& b) { return a.loss() < b.loss(); });
  runner.run(best, last);
  ThreadFit fit{.parameters = parameters_of(best.unknowns),
                .rounds = best.rounds,
                .start = best.start,
                .block_px = objective.block_px(),
                .blocks = objective.block_count()};
  fit.parameters.limit_energy = true;
  return fit;
}

}  // namespace inversion
