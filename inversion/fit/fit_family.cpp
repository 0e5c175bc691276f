#include "inversion/fit/fit_family.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "inversion/fit/loss_terms.h"
#include "inversion/fit/mean_terms.h"
#include "inversion/fit/noise_weights.h"
#include "inversion/fit/pixel_loss.h"
#include "inversion/fit/step_coordinates.h"
#include "inversion/fit/view_objective.h"
#include "inversion/solve/adam.h"
#include "inversion/solve/bias_free.h"

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int kMostSteps = 40;
constexpr int kMostReweighings = 4;
constexpr double kSettledWeight = 0.1;
constexpr const char* kStopped = "the fit was stopped on request; start it again for a thread";

struct FollowLoss : ceres::IterationCallback {
  std::function<bool(int)> go_on;
  std::vector<double>* losses = nullptr;
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    losses->push_back(step.cost);
    return go_on(step.iteration) ? ceres::SOLVER_CONTINUE : ceres::SOLVER_ABORT;
  }
};

// What is searched, and how.
struct Search {
  const ScatteringFamily* family;
  const FitOptions* options;
  Effort effort;
  FamilyUnknowns unknowns;
  std::vector<int> held;  // indices of unknowns
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
  const PriorTerm prior(prior_scale);
  if (prior_scale > 0) problem.AddResidualBlock(new PriorTerm(prior_scale), nullptr, unknowns.data());
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
  if (summary.termination_type == ceres::USER_FAILURE) throw std::runtime_error(kStopped);
  if (!summary.IsSolutionUsable())
    throw std::runtime_error("the fit found no thread: " + summary.message + "; look at the views and their masks");
  round.steps = static_cast<int>(summary.iterations.size()) - 1;
  round.loss_before = summary.initial_cost, round.loss_after = summary.final_cost;
  if (prior_scale > 0) round.prior_share = prior.loss(unknowns) / std::max(round.loss_after, 1e-300);
  round.converged = summary.termination_type == ceres::CONVERGENCE;
  return round;
}

// One search from one start, round after round.
struct Attempt {
  int start = 0;
  VectorXd unknowns;
  std::vector<FitRound> rounds{};
  double prior_scale = 0;  // in the last round
  std::vector<double> view_weights{};
  double loss() const { return rounds.empty() ? 0 : rounds.back().loss_after; }
};

bool has_prior(const Search& search) {
  return search.options->model == ModelKind::thread && !search.options->tinted;
}

// The prior's chi square counts as much as that of residuals of the size that the round before left.
double prior_scale(const ViewObjective& objective, const Search& search, const std::vector<FitRound>& before) {
  if (!has_prior(search)) return 0;
  const auto last =
      std::find_if(before.rbegin(), before.rend(), [](const FitRound& round) { return !round.bias_free; });
  if (last == before.rend()) return 0;
  return search.options->prior_weight * 2 * last->loss_after / objective.residual_count();
}

class RoundRunner {
 public:
  RoundRunner(ViewObjective& objective, const Search& search, std::size_t starts)
      : objective_(objective), search_(search) {
    const std::vector<int>& paths = search.options->paths_per_block;
    for (std::size_t round = 0; round < paths.size(); ++round)
      whole_ += paths[round] * (round + 1 < paths.size() ? static_cast<double>(starts) : 1.0);
  }

  // robustly: the blocks are weighed at the attempt's unknowns first.
  void run(Attempt& attempt, std::size_t round, bool robustly = false) {
    constexpr double kTracingShare = 0.4;
    const FitOptions& options = *search_.options;
    const int paths = options.paths_per_block[round];
    const std::string name = "start " + std::to_string(attempt.start + 1) + ", round " + std::to_string(round + 1) +
                             " of " + std::to_string(options.paths_per_block.size());
    const auto go_on = [&](const std::string& what, double share) {
      return !options.progress || options.progress(name + ", " + what, (done_ + share * paths) / whole_);
    };
    // Every start gets the same seed, because the starts' losses are compared: pixels and random numbers are alike,
    // though the paths part where they are traced with other parameters.
    objective_.trace(attempt.unknowns, paths, options.seed + kFitSeedStep * round, [&](int views_done, int total) {
      if (!go_on("tracing", kTracingShare * views_done / total)) throw std::runtime_error(kStopped);
    });
    // The prior counts from the last short round on. If that is the first, it counts as much as the paths' noise: what
    // they say nothing of stays near the prior.
    const bool last_short = round + 2 == options.paths_per_block.size();
    const double first_scale = last_short && has_prior(search_)
                                   ? options.prior_weight * objective_.residual_variances(attempt.unknowns).mean()
                                   : 0;
    const auto search_on = [&] {
      attempt.prior_scale = attempt.rounds.empty() ? first_scale : prior_scale(objective_, search_, attempt.rounds);
      return solve(
          objective_, search_, attempt.prior_scale,
          [&](int step) {
            return go_on("step " + std::to_string(step), kTracingShare + (1 - kTracingShare) * step / kMostSteps);
          },
          attempt.unknowns);
    };
    if (robustly) attempt.view_weights = objective_.weigh_robustly(attempt.unknowns);
    attempt.rounds.push_back(search_on());
    // A bad view has pulled the fit towards itself before it is told from the others: as it loses weight, it stands out
    // more.
    for (int again = 0; robustly && again < kMostReweighings; ++again) {
      std::vector<double> weights = objective_.weigh_robustly(attempt.unknowns);
      const bool settled = std::equal(weights.begin(), weights.end(), attempt.view_weights.begin(),
                                      [](double x, double y) { return std::abs(x - y) < kSettledWeight; });
      attempt.view_weights = std::move(weights);
      if (settled) break;
      attempt.rounds.back() = search_on();
    }
    attempt.rounds.back().paths_per_block = paths;
    done_ += paths;
  }

 private:
  ViewObjective& objective_;
  const Search& search_;
  double whole_ = 0, done_ = 0;
};

// NoiseWeights' groups.
std::vector<int> views_and_colours(const ViewObjective& objective) {
  std::vector<int> groups = objective.residual_views();
  for (std::size_t i = 0; i < groups.size(); ++i) groups[i] = 3 * groups[i] + static_cast<int>(i % 3);
  return groups;
}

// The residuals of an attempt by paths that no attempt has seen.
struct Tested {
  VectorXd variances, products;  // as NoiseWeights takes them
};
Tested tested(ViewObjective& objective, const Search& search, const VectorXd& unknowns) {
  const FitOptions& options = *search.options;
  objective.trace(unknowns, options.paths_per_block.back(), options.seed - kFitSeedStep, [&](int, int) {
    if (options.progress && !options.progress("comparing starts", 0)) throw std::runtime_error(kStopped);
  });
  const ViewObjective::Halves both = objective.halves(unknowns);
  return {.variances = objective.residual_variances(unknowns),
          .products = both.residuals[0].cwiseProduct(both.residuals[1]) - objective.photograph_variances()};
}

// The number of the attempt whose misfit is least when all are weighted by the noise alike. The loss of eq. 6 on an
// attempt's own paths is mostly their noise, which is least where lobes are wide.
std::size_t nearest(ViewObjective& objective, const Search& search, const std::vector<Attempt>& attempts) {
  std::vector<Tested> all;
  for (const Attempt& attempt : attempts) all.push_back(tested(objective, search, attempt.unknowns));
  NoiseWeights weights(views_and_colours(objective));
  for (const Tested& one : all) weights.add(one.variances, one.products);
  const VectorXd factors = weights.factors();
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double misfit = all[i].products.dot(factors.cwiseAbs2());
    if (misfit < least) least = misfit, best = i;
  }
  return best;
}

Attempt search_by_rounds(ViewObjective& objective, const Search& search, const std::vector<VectorXd>& starts,
                         bool without_bias) {
  std::vector<Attempt> attempts;
  for (const VectorXd& start : starts)
    attempts.push_back({.start = static_cast<int>(attempts.size()), .unknowns = start});
  RoundRunner runner(objective, search, attempts.size());
  const std::size_t last = search.options->paths_per_block.size() - 1;
  for (Attempt& attempt : attempts)
    for (std::size_t round = 0; round < last; ++round) runner.run(attempt, round);
  Attempt& best = attempts.size() > 1 && without_bias
                      ? attempts[nearest(objective, search, attempts)]
                      : *std::min_element(attempts.begin(), attempts.end(),
                                          [](const Attempt& a, const Attempt& b) { return a.loss() < b.loss(); });
  runner.run(best, last, search.options->robust && last > 0);
  return best;
}

// LinearisedFit::bounds.
std::vector<int> touched_bounds(const Search& search, const VectorXd& unknowns) {
  constexpr double kTouching = 1e-9;
  const VectorXd &low = search.unknowns.lower, &high = search.unknowns.upper;
  std::vector<int> bounds;
  for (Eigen::Index k = 0; k < unknowns.size(); ++k)
    bounds.push_back(unknowns[k] <= low[k] + kTouching ? -1 : unknowns[k] >= high[k] - kTouching ? 1 : 0);
  return bounds;
}

// The fit by the paths that were recorded last, without the gradient and what several sets of paths say.
LinearisedFit linearised(const ViewObjective& objective, const Search& search, double prior_scale,
                         const VectorXd& unknowns) {
  LinearisedFit fit;
  RowMajor jacobian(objective.residual_count(), unknowns.size());
  fit.residuals.resize(objective.residual_count());
  objective.residuals(unknowns, fit.residuals.data(), jacobian.data());
  fit.jacobian = jacobian;
  fit.variances = objective.residual_variances(unknowns);
  fit.views = objective.residual_views();
  fit.held.assign(static_cast<std::size_t>(unknowns.size()), false);
  for (int k : search.held) fit.held[static_cast<std::size_t>(k)] = true;
  fit.bounds = touched_bounds(search, unknowns);
  fit.scales = VectorXd::Ones(unknowns.size());
  fit.penalty_jacobian = OtherTerms(*search.family, 0).jacobian(unknowns);
  if (prior_scale > 0) fit.prior_jacobian = PriorTerm(prior_scale).jacobian();
  return fit;
}

// The spread of where Levenberg-Marquardt has ended.
MatrixXd spread_of_rounds(const ViewObjective& objective, const Search& search, const Attempt& attempt) {
  if (attempt.rounds.empty()) return MatrixXd::Zero(attempt.unknowns.size(), attempt.unknowns.size());
  LinearisedFit fit = linearised(objective, search, attempt.prior_scale, attempt.unknowns);
  fit.gradient_covariance = gradient_covariance(fit.jacobian, fit.residuals);
  return certainty_of(fit).noise_covariance;
}

// What a set of paths counts of the next one in `Unbiased::mean`, on the approach: the Hessian changes less there than
// by its noise.
constexpr double kOldInMean = 0.8;

// Where steps without bias have ended.
struct Unbiased {
  MeanTerms mean{};           // of the sets of paths
  Eigen::VectorXd factors{};  // of the residuals of eq. 6, as in the last of them; empty: 1
  double variance = 0;        // of the mean residual of all sets, as the steps weigh them
  double prior_scale = 0;     // of PriorTerm
  Eigen::MatrixXd left{};     // BiasFreeEnd, of the unknowns
  Eigen::MatrixXd start_covariance{};
};

// Goes on from where the search has ended by steps without bias, whose residuals are weighted by their noise. The
// prior's chi square counts as much as that of the mean over all sets of paths: by the noise of one set it would draw
// an unusual thread away from what its photographs say. The last step's paths remain recorded.
Unbiased remove_bias(ViewObjective& objective, const Search& search, Attempt& attempt) {
  const FitOptions& options = *search.options;
  const int paths = options.paths_per_block.back();
  const bool with_prior = has_prior(search) && !attempt.rounds.empty();
  const VectorXd photographs = objective.photograph_variances();
  const StepCoordinates coordinates(search.unknowns);
  NoiseWeights weights(views_and_colours(objective));
  const auto learn_noise = [&](const ViewObjective::Halves& both, const VectorXd& unknowns) {
    weights.add(objective.residual_variances(unknowns),
                both.residuals[0].cwiseProduct(both.residuals[1]) - photographs);
  };
  Unbiased end{.start_covariance = spread_of_rounds(objective, search, attempt)};
  double sets = 0, squared_sets = 0;
  const BiasFreeOptions steps{.lower = coordinates.of(search.unknowns.lower),
                              .upper = coordinates.of(search.unknowns.upper),
                              .held = search.held,
                              .exact =
                                  [&](const VectorXd& at) {
                                    const VectorXd unknowns = coordinates.unknowns(at);
                                    OtherTerms others(*search.family, end.prior_scale);
                                    return coordinates.of(others.at(unknowns), unknowns);
                                  },
                              .approach_steps = search.effort.approach_steps,
                              .joint_steps = search.effort.joint_steps};
  const auto loss = [&](int step, const VectorXd& at) {
    const VectorXd unknowns = coordinates.unknowns(at);
    const std::string name = "without bias, step " + std::to_string(step + 1);
    const auto number = options.paths_per_block.size() + static_cast<std::size_t>(step);
    const double done = attempt.rounds.empty() ? step / (1.0 * steps.approach_steps + steps.joint_steps) : 1;
    objective.trace(unknowns, paths, options.seed + kFitSeedStep * number, [&](int, int) {
      if (options.progress && !options.progress(name, done)) throw std::runtime_error(kStopped);
    });
    ViewObjective::Halves both = objective.halves(unknowns);
    end.factors = weights.factors();
    const double variance = weights.weighted_variance(), alike = weights.variance_alike(photographs);
    learn_noise(both, unknowns);
    scale_rows(both, end.factors);
    const double old = step < steps.approach_steps ? steps.old : 1.0;
    end.mean.add(both, unknowns, std::max(old, kOldInMean));
    sets = old * sets + 1, squared_sets = old * old * squared_sets + 1;
    end.variance = alike + (variance - alike) * squared_sets / (sets * sets);
    if (with_prior) end.prior_scale = options.prior_weight * end.variance;
    BiasFreeTerms terms = data_terms(both);
    if (search.effort.by_whole_hessian) terms.hessian = whole_hessian(both);
    terms.variance = variance;
    return coordinates.of(std::move(terms), unknowns);
  };
  if (attempt.rounds.empty()) objective.trace(attempt.unknowns, paths, options.seed, [](int, int) {});
  if (options.robust && search.effort.robust) attempt.view_weights = objective.weigh_robustly(attempt.unknowns);
  learn_noise(objective.halves(attempt.unknowns), attempt.unknowns);
  FitRound round{.paths_per_block = paths, .bias_free = true, .converged = true};
  VectorXd at = coordinates.of(attempt.unknowns);
  const VectorXd slopes = coordinates.slopes(attempt.unknowns);
  BiasFreeEnd reached = minimise_bias_free(loss, steps, at);
  attempt.unknowns = coordinates.unknowns(at);
  end.left = coordinates.slopes(attempt.unknowns).asDiagonal() * reached.left * slopes.cwiseInverse().asDiagonal();
  round.losses = std::move(reached.losses);
  round.steps = static_cast<int>(round.losses.size());
  round.loss_before = round.losses.front(), round.loss_after = round.losses.back();
  attempt.rounds.push_back(std::move(round));
  return end;
}

// By the loss of the pictures alone, with light paths of each step's own.
Attempt search_by_adam(const Search& search, const VectorXd& start, int paths, const StochasticLoss& of_pictures) {
  const FitOptions& options = *search.options;
  Attempt attempt{.unknowns = start};
  VectorXd low = search.unknowns.lower, high = search.unknowns.upper;
  for (int k : search.held) low[k] = high[k] = start[k];
  OtherTerms others(*search.family, 0);
  const auto evaluate = [&](int step, const VectorXd& unknowns, VectorXd& gradient) {
    const double share = (step - 1.0) / options.adam_steps;
    if (options.progress && !options.progress("step " + std::to_string(step), share))
      throw std::runtime_error(kStopped);
    const double loss = of_pictures(step, unknowns, gradient);
    const BiasFreeTerms other = others.at(unknowns);
    gradient += other.gradient;
    return loss + other.loss;
  };
  FitRound round{.paths_per_block = paths, .steps = options.adam_steps};
  round.losses = minimise_by_adam(evaluate, {.steps = options.adam_steps}, low, high, attempt.unknowns);
  round.loss_before = round.losses.front();
  VectorXd gradient(start.size());
  round.loss_after = evaluate(options.adam_steps + 1, attempt.unknowns, gradient);
  round.losses.push_back(round.loss_after);
  attempt.rounds.push_back(std::move(round));
  return attempt;
}

std::uint64_t seed_of_step(const FitOptions& options, int step) {
  return options.seed + kFitSeedStep * static_cast<std::uint64_t>(step);
}

Attempt search_by_adam(ViewObjective& objective, const Search& search, const VectorXd& start) {
  const FitOptions& options = *search.options;
  return search_by_adam(search, start, options.adam_paths, [&](int step, const VectorXd& unknowns, VectorXd& gradient) {
    objective.trace(unknowns, options.adam_paths, seed_of_step(options, step), [](int, int) {});
    VectorXd residuals(objective.residual_count());
    RowMajor jacobian(objective.residual_count(), unknowns.size());
    objective.residuals(unknowns, residuals.data(), jacobian.data());
    gradient = jacobian.transpose() * residuals;
    return 0.5 * residuals.squaredNorm();
  });
}

// Ends with paths of the objective at the unknowns found, which tell how certain they are.
Attempt search_by_pixels(const PixelLoss& pixels, ViewObjective& objective, const Search& search,
                         const VectorXd& start) {
  const FitOptions& options = *search.options;
  Attempt attempt = search_by_adam(
      search, start, options.paths_per_pixel, [&](int step, const VectorXd& unknowns, VectorXd& gradient) {
        return pixels.at(unknowns, options.paths_per_pixel, seed_of_step(options, step), gradient);
      });
  attempt.rounds.back().bias_free = true;
  objective.trace(attempt.unknowns, options.adam_paths, seed_of_step(options, options.adam_steps + 2), [](int, int) {});
  return attempt;
}

// The certainty at the unknowns, by the paths that were recorded last and by the terms met on the way there, if any.
Certainty certainty_at(const ViewObjective& objective, const Search& search, double prior_scale,
                       const VectorXd& unknowns, Unbiased end) {
  LinearisedFit fit = linearised(objective, search, prior_scale, unknowns);
  if (end.factors.size() > 0) {
    fit.residuals.array() *= end.factors.array();
    fit.jacobian = end.factors.asDiagonal() * fit.jacobian;
    fit.variances.array() *= end.factors.array().square();
  }
  if (end.mean.empty()) end.mean.add(objective.halves(unknowns), unknowns);
  fit.hessian = end.mean.hessian();
  fit.gradient_covariance = end.mean.gradient_covariance(unknowns);
  fit.gradient = end.mean.gradient(unknowns) + OtherTerms(*search.family, prior_scale).at(unknowns).gradient;
  fit.mean_variance = end.variance;
  fit.left = std::move(end.left);
  fit.start_covariance = std::move(end.start_covariance);
  return certainty_of(fit);
}

}  // namespace

ViewFit fit_family(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options,
                   const ScatteringFamily& family, const std::vector<VectorXd>& starts, const Effort& effort) {
  ViewObjective objective(spool, views, family, effort.block_stride);
  Search search{.family = &family, .options = &options, .effort = effort, .unknowns = unknowns_of(family), .held = {}};
  if (options.model == ModelKind::thread)
    for (int k = 0; k < static_cast<int>(search.unknowns.names.size()); ++k)
      if (std::find(options.held.begin(), options.held.end(), group_of(k)) != options.held.end())
        search.held.push_back(k);
  const bool by_pixels = options.model == ModelKind::paper, by_adam = !by_pixels && options.solver == Solver::adam,
             without_bias = !by_pixels && !by_adam && options.without_bias &&
                            options.paths_per_block.back() >= kFewestPathsWithoutBias;
  Attempt best = by_pixels ? search_by_pixels(PixelLoss(spool, views, family), objective, search, starts.front())
                 : by_adam ? search_by_adam(objective, search, starts.front())
                 : effort.rounds || !without_bias ? search_by_rounds(objective, search, starts, without_bias)
                                                  : Attempt{.unknowns = starts.front()};
  Unbiased end;
  double scale = best.prior_scale;
  if (without_bias) {
    end = remove_bias(objective, search, best);
    scale = end.prior_scale;
  }
  ViewFit fit{
      .family = family,
      .model = model_at(family, best.unknowns),
      .unknowns = best.unknowns,
      .unknown_names = search.unknowns.names,
      .certainty = certainty_at(objective, search, scale, best.unknowns, std::move(end)),
      .rounds = best.rounds,
      .start = best.start,
      .view_weights = best.view_weights.empty() ? std::vector<double>(views.size(), 1.0) : std::move(best.view_weights),
      .block_px = objective.block_px(),
      .blocks = objective.block_count()};
  if (auto* thread = std::get_if<renderer::ThreadParameters>(&fit.model)) thread->limit_energy = !by_pixels;
  return fit;
}

}  // namespace inversion
