#include "inversion/fit/unbiased_steps.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "inversion/fit/block_covariance.h"
#include "inversion/fit/loss_terms.h"
#include "inversion/fit/noise_weights.h"
#include "inversion/fit/step_coordinates.h"
#include "inversion/solve/bias_free.h"

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kOldNoise = 0.5;  // what a set's variances count of the next one's

// What a set of paths counts of the next one in `UnbiasedEnd::sets`, on the approach: the Hessian changes less there
// than by its noise.
constexpr double kOldInCertainty = 0.8;

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
  fit.held.assign(static_cast<std::size_t>(unknowns.size()), false);
  for (int k : search.held) fit.held[static_cast<std::size_t>(k)] = true;
  fit.bounds = touched_bounds(search, unknowns);
  fit.scales = VectorXd::Ones(unknowns.size());
  fit.penalty_jacobian = OtherTerms(*search.family, 0, false).penalty_jacobian(unknowns);
  if (prior_scale > 0) fit.prior_jacobian = ThreadPriorTerm(prior_scale).known_rows(unknowns);
  return fit;
}

// Adds a set of paths traced at these coordinates, by the unknowns' slopes there, its residuals times their factors.
void add_set(JoinedSets& sets, ViewObjective::Halves both, const VectorXd& factors, const VectorXd& at,
             const VectorXd& slopes, double old) {
  for (std::size_t h = 0; h < 2; ++h) {
    both.residuals[h].array() *= factors.array();
    both.jacobians[h] = factors.asDiagonal() * both.jacobians[h] * slopes.asDiagonal();
  }
  sets.add(both.residuals, both.jacobians, at, old);
}

}  // namespace

UnbiasedEnd remove_bias(ViewObjective& objective, const Search& search, int first_trace,
                        const std::function<void(int)>& show, Attempt& attempt) {
  const FitOptions& options = *search.options;
  const int paths = options.paths_per_block.back();
  const bool with_prior = search.has_prior() && !attempt.rounds.empty();
  const VectorXd photographs = objective.photograph_variances();
  const StepCoordinates coordinates(search.unknowns);
  NoiseWeights weights(views_and_colours(objective), kOldNoise);
  const auto learn_noise = [&](const ViewObjective::Halves& both) {
    weights.add(both.variances, both.residuals[0].cwiseProduct(both.residuals[1]) - photographs);
  };
  const auto count = attempt.unknowns.size();
  UnbiasedEnd end{.start_covariance =
                      attempt.covariance.size() > 0 ? attempt.covariance : MatrixXd::Zero(count, count)};
  JoinedSets sets;
  const BiasFreeOptions steps{.lower = coordinates.of(search.unknowns.lower),
                              .upper = coordinates.of(search.unknowns.upper),
                              .held = search.held,
                              .exact =
                                  [&](const VectorXd& at) {
                                    const VectorXd unknowns = coordinates.unknowns(at);
                                    OtherTerms others(*search.family, end.prior_scale, false);
                                    return coordinates.of(others.at(unknowns), unknowns);
                                  },
                              .limits =
                                  [&](const VectorXd& at) {
                                    const VectorXd unknowns = coordinates.unknowns(at);
                                    EnergyLimits limits = energy_limits(*search.family, unknowns);
                                    limits.rows *= coordinates.slopes(unknowns).asDiagonal();
                                    return BiasFreeOptions::Limits{std::move(limits.excess), std::move(limits.rows)};
                                  },
                              .approach_steps = search.effort.approach_steps,
                              .joint_steps = search.effort.joint_steps};
  const auto loss = [&](int step, const VectorXd& at, double old) {
    const VectorXd unknowns = coordinates.unknowns(at), slopes = coordinates.slopes(unknowns);
    objective.trace(unknowns, paths, seed_of_trace(options, first_trace + step), [&](int, int) { show(step); });
    const ViewObjective::Halves both = objective.halves(unknowns);
    end.factors = weights.factors();
    const double variance = weights.weighted_variance(), alike = weights.variance_alike(photographs);
    learn_noise(both);
    add_set(sets, both, end.factors, at, slopes, old);
    add_set(end.sets, both, end.factors, at, slopes, std::max(old, kOldInCertainty));
    end.variance = alike + (variance - alike) * sets.variance_of_mean();
    if (with_prior) end.prior_scale = options.prior_weight * end.variance;
    BiasFreeTerms terms = sets.at(at);
    if (search.effort.by_whole_hessian) terms.hessian = sets.whole_hessian();
    terms.variance = variance;
    terms.curvature_deviation = [&](const VectorXd& direction) { return sets.curvature_deviation(direction); };
    end.damping = variance / (steps.reach * steps.reach);
    return terms;
  };
  if (options.robust && search.effort.robust && attempt.view_weights.empty())
    attempt.view_weights = objective.weigh_robustly(attempt.unknowns);
  learn_noise(objective.halves(attempt.unknowns));
  FitRound round{.paths_per_block = paths, .bias_free = true, .converged = true};
  VectorXd at = coordinates.of(attempt.unknowns);
  const VectorXd slopes = coordinates.slopes(attempt.unknowns);
  BiasFreeEnd reached = minimise_bias_free(loss, steps, at);
  attempt.unknowns = coordinates.unknowns(at);
  const VectorXd slopes_there = coordinates.slopes(attempt.unknowns);
  end.left = slopes_there.asDiagonal() * reached.left * slopes.cwiseInverse().asDiagonal();
  end.gain = slopes_there.asDiagonal() * reached.gain * slopes_there.asDiagonal();
  round.losses = std::move(reached.losses);
  round.steps = static_cast<int>(round.losses.size());
  round.loss_before = round.losses.front(), round.loss_after = round.losses.back();
  attempt.rounds.push_back(std::move(round));
  attempt.prior_scale = end.prior_scale;
  return end;
}

Certainty certainty_at(const ViewObjective& objective, const Search& search, double prior_scale,
                       const VectorXd& unknowns, UnbiasedEnd end) {
  LinearisedFit fit = linearised(objective, search, prior_scale, unknowns);
  if (end.factors.size() > 0) {
    fit.residuals.array() *= end.factors.array();
    fit.jacobian = end.factors.asDiagonal() * fit.jacobian;
    fit.variances.array() *= end.factors.array().square();
  }
  const StepCoordinates coordinates(search.unknowns);
  const VectorXd at = coordinates.of(unknowns), slopes = coordinates.slopes(unknowns);
  if (end.sets.empty())
    add_set(end.sets, objective.halves(unknowns), VectorXd::Ones(objective.residual_count()), at, slopes, 1);
  const VectorXd inverse = slopes.cwiseInverse();
  const MatrixXd gradients = inverse.asDiagonal() * end.sets.gradients(at);
  fit.hessian = inverse.asDiagonal() * end.sets.hessian() * inverse.asDiagonal();
  fit.curvature_deviation = [&](const VectorXd& direction) {
    return end.sets.curvature_deviation(inverse.cwiseProduct(direction));
  };
  fit.gradient_covariance = block_covariance(gradients);
  // Each colour of a view errs as a whole, because misfit is smooth over a view.
  VectorXd photographs = objective.photograph_variances();
  if (end.factors.size() > 0) photographs.array() *= end.factors.array().square();
  fit.misfit_covariance = inverse.asDiagonal() *
                          end.sets.misfit_covariance(at, views_and_colours(objective), photographs) *
                          inverse.asDiagonal();
  fit.gradient = gradients.rowwise().sum() + OtherTerms(*search.family, prior_scale).at(unknowns).gradient;
  fit.mean_variance = end.variance;
  fit.left = std::move(end.left);
  fit.gain = std::move(end.gain);
  fit.damping = end.damping;
  fit.start_covariance = std::move(end.start_covariance);
  return certainty_of(fit);
}

MatrixXd covariance_of_round(const ViewObjective& objective, const Search& search, const Attempt& attempt) {
  LinearisedFit fit = linearised(objective, search, attempt.prior_scale, attempt.unknowns);
  fit.gradient_covariance = block_covariance(fit.jacobian.transpose() * fit.residuals.asDiagonal());
  return certainty_of(fit).noise_covariance;
}

}  // namespace inversion
