#include "inversion/fit/fit_family.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "inversion/fit/levenberg_rounds.h"
#include "inversion/fit/loss_terms.h"
#include "inversion/fit/misfit_comparison.h"
#include "inversion/fit/pixel_loss.h"
#include "inversion/fit/search.h"
#include "inversion/fit/start_choice.h"
#include "inversion/fit/thread_unknowns.h"
#include "inversion/fit/unbiased_steps.h"
#include "inversion/fit/view_objective.h"
#include "inversion/solve/adam.h"

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// By the loss of the pictures alone, with light paths of each step's own.
Attempt search_by_adam(const Search& search, const VectorXd& start, int paths, const StochasticLoss& of_pictures) {
  const FitOptions& options = *search.options;
  Work work(options, options.adam_steps);
  Attempt attempt{.unknowns = start};
  VectorXd low = search.unknowns.lower, high = search.unknowns.upper;
  for (int k : search.held) low[k] = high[k] = start[k];
  OtherTerms others(*search.family, 0);
  const auto evaluate = [&](int step, const VectorXd& unknowns, VectorXd& gradient) {
    work.show("step " + std::to_string(step), step - 1);
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

Attempt search_by_adam(ViewObjective& objective, const Search& search, const VectorXd& start) {
  const FitOptions& options = *search.options;
  return search_by_adam(search, start, options.adam_paths, [&](int step, const VectorXd& unknowns, VectorXd& gradient) {
    objective.trace(unknowns, options.adam_paths, seed_of_trace(options, step), [](int, int) {});
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
        return pixels.at(unknowns, options.paths_per_pixel, seed_of_trace(options, step), gradient);
      });
  attempt.rounds.back().bias_free = true;
  objective.trace(attempt.unknowns, options.adam_paths, seed_of_trace(options, options.adam_steps + 2),
                  [](int, int) {});
  return attempt;
}

constexpr int kComparedEnds = 8;  // sets of paths

// Levenberg-Marquardt, and if asked for the steps without bias behind it.
class LevenbergFit {
 public:
  LevenbergFit(const WrappedSpool& spool, const std::vector<View>& views, ViewObjective& objective,
               const Search& search, const std::vector<VectorXd>& starts, bool without_bias)
      : spool_(spool),
        views_(views),
        objective_(objective),
        search_(search),
        starts_(starts),
        without_bias_(without_bias),
        work_(*search.options, whole_work()) {}

  struct Ended {
    Attempt attempt;
    Certainty certainty;
  };

  Ended run() {
    Attempt best = search_.effort.rounds || !without_bias_ ? by_rounds() : at_first_start();
    if (!without_bias_) {
      Certainty certainty = certainty_at(objective_, search_, best.prior_scale, best.unknowns, {});
      return {std::move(best), std::move(certainty)};
    }
    Ended end = without_bias(std::move(best), "without bias");
    work_.finish(work_of_steps());
    if (seeks_thread()) end = widened(std::move(end));
    if (!exchanged_) return end;
    Ended other = widened(at_other_end(*std::move(exchanged_), "R and TRT exchanged"));
    return nearer(std::move(end), std::move(other));
  }

 private:
  int rounds() const { return static_cast<int>(search_.options->paths_per_block.size()); }
  double last_paths() const { return search_.options->paths_per_block.back(); }
  bool chooses() const { return without_bias_ && starts_.size() > 1; }
  // From several starts: where R and TRT may be exchanged and lobes get lost.
  bool seeks_thread() const { return chooses() && std::holds_alternative<ThreadFamily>(*search_.family); }
  static constexpr double kWorkOfComparison = 2.0 * kComparedEnds * MisfitComparison::kPaths;
  double work_of_other_end() const { return 2 * work_of_steps() + kWorkOfComparison; }
  double work_of_steps() const { return last_paths() * steps(); }
  int steps() const { return search_.effort.approach_steps + search_.effort.joint_steps; }

  double whole_work() const {
    const std::vector<int>& paths = search_.options->paths_per_block;
    double work = without_bias_ ? work_of_steps() : 0;
    if (seeks_thread()) work += work_of_other_end();
    if (!search_.effort.rounds && without_bias_) return work;
    work += last_paths() + static_cast<double>(starts_.size()) * std::accumulate(paths.begin(), paths.end() - 1, 0.0);
    return chooses() ? work + work_of_choice(search_, objective_.block_count(), starts_.size()) : work;
  }

  Attempt at_first_start() {
    Attempt attempt{.unknowns = starts_.front()};
    trace_at(attempt.unknowns);
    return attempt;
  }

  void trace_at(const VectorXd& unknowns) {
    objective_.trace(unknowns, static_cast<int>(last_paths()), search_.options->seed,
                     [&](int, int) { work_.show("without bias", 0); });
  }

  // Of a search that begins with other widths: its energies follow, and the joint sets of the first pass, which count
  // them alike all the way, leave them behind. So one end is compared with another after a second pass.
  Ended at_other_end(Attempt attempt, const std::string& name, int behind = 0) {
    trace_at(attempt.unknowns);
    Ended end = without_bias(std::move(attempt), name, behind);
    work_.finish(work_of_steps());
    end.attempt.covariance = end.certainty.noise_covariance;
    end = without_bias(std::move(end.attempt), name, behind + steps());
    work_.finish(work_of_steps());
    return end;
  }

  // Of a lobe that is as narrow as lobes may be few paths tell that it is too narrow, and a search that noise has led
  // there does not come back. It goes on once more from where that lobe is as wide as at the first start.
  Ended widened(Ended end) {
    constexpr double kNarrow = 3;  // in least widths
    Attempt wider = end.attempt;
    for (int k = kBeta; k < kBeta + 3; ++k)
      if (wider.unknowns[k] < kNarrow * search_.unknowns.lower[k]) wider.unknowns[k] = starts_.front()[k];
    if (wider.unknowns == end.attempt.unknowns) return end;
    work_.add(work_of_other_end());
    wider.covariance = end.certainty.noise_covariance;
    Ended other = at_other_end(std::move(wider), "narrow lobes widened", 2 * steps());
    return nearer(std::move(end), std::move(other));
  }

  // Two at a time: the noise of a narrow lobe counts in the weights of all that are compared with it.
  Ended nearer(Ended end, Ended other) {
    MisfitComparison comparison(objective_, *search_.options, kComparedEnds);
    for (const Ended* one : {&end, &other})
      comparison.add(one->attempt.unknowns, [&] {
        work_.finish(MisfitComparison::kPaths);
        work_.show("comparing ends", 0);
      });
    return comparison.from_nearest().front() == 0 ? end : other;
  }

  // Behind so many steps of the same search, whose paths it does not trace again.
  Ended without_bias(Attempt attempt, const std::string& name, int behind = 0) {
    UnbiasedEnd end = remove_bias(
        objective_, search_, rounds() + behind,
        [&](int step) { work_.show(name + ", step " + std::to_string(behind + step + 1), step * last_paths()); },
        attempt);
    Certainty certainty = certainty_at(objective_, search_, attempt.prior_scale, attempt.unknowns, std::move(end));
    return {std::move(attempt), std::move(certainty)};
  }

  // Every start goes through all rounds but the last, which is for the nearest.
  Attempt by_rounds() {
    const int last = rounds() - 1;
    std::vector<Attempt> attempts;
    for (const VectorXd& start : starts_) {
      Attempt attempt{.start = static_cast<int>(attempts.size()), .unknowns = start};
      for (int round = 0; round < last; ++round) run_round(objective_, search_, round, false, work_, attempt);
      if (chooses() && last > 0) attempt.covariance = covariance_of_round(objective_, search_, attempt);
      attempts.push_back(std::move(attempt));
    }
    const bool robustly = search_.options->robust && last > 0;
    if (!chooses()) {
      Attempt best = *std::min_element(attempts.begin(), attempts.end(),
                                       [](const Attempt& a, const Attempt& b) { return a.loss() < b.loss(); });
      run_round(objective_, search_, last, robustly, work_, best);
      best.covariance = covariance_of_round(objective_, search_, best);
      return best;
    }
    auto [best, exchanged] =
        nearest_search(spool_, views_, objective_.block_count(), search_, std::move(attempts), work_);
    // The round tells which views and blocks are bad. The nearest search is nearer than where it ends.
    const VectorXd nearest = best.unknowns;
    run_round(objective_, search_, last, robustly, work_, best);
    best.unknowns = nearest;
    exchanged_ = std::move(exchanged);
    if (exchanged_)
      exchanged_->rounds = best.rounds, exchanged_->view_weights = best.view_weights;
    else if (seeks_thread())
      work_.drop(work_of_other_end());
    return std::move(best);
  }

  const WrappedSpool& spool_;
  const std::vector<View>& views_;
  ViewObjective& objective_;
  const Search& search_;
  const std::vector<VectorXd>& starts_;
  bool without_bias_;
  Work work_;
  std::optional<Attempt> exchanged_;  // NearestSearch
};

}  // namespace

ViewFit fit_family(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options,
                   const ScatteringFamily& family, const std::vector<VectorXd>& starts, const Effort& effort) {
  ViewObjective objective(spool, views, family, effort.block_stride);
  Search search{.family = &family, .options = &options, .effort = effort, .unknowns = unknowns_of(family), .held = {}};
  if (options.model == ModelKind::thread)
    for (int k = 0; k < static_cast<int>(search.unknowns.names.size()); ++k)
      if (std::find(options.held.begin(), options.held.end(), group_of(k)) != options.held.end())
        search.held.push_back(k);
  const auto [best, certainty] = [&]() -> LevenbergFit::Ended {
    const bool by_pixels = options.model == ModelKind::paper;
    if (by_pixels || options.solver == Solver::adam) {
      Attempt attempt = by_pixels ? search_by_pixels(PixelLoss(spool, views, family), objective, search, starts.front())
                                  : search_by_adam(objective, search, starts.front());
      Certainty certain = certainty_at(objective, search, 0, attempt.unknowns, {});
      return {std::move(attempt), std::move(certain)};
    }
    const bool without_bias = options.without_bias && options.paths_per_block.back() >= kFewestPathsWithoutBias;
    return LevenbergFit(spool, views, objective, search, starts, without_bias).run();
  }();
  ViewFit fit{.family = family,
              .model = model_at(family, best.unknowns),
              .unknowns = best.unknowns,
              .unknown_names = search.unknowns.names,
              .certainty = certainty,
              .rounds = best.rounds,
              .start = best.start,
              .view_weights = best.view_weights.empty() ? std::vector<double>(views.size(), 1.0) : best.view_weights,
              .block_px = objective.block_px(),
              .blocks = objective.block_count()};
  if (auto* thread = std::get_if<renderer::ThreadParameters>(&fit.model))
    thread->limit_energy = options.model != ModelKind::paper;
  return fit;
}

}  // namespace inversion
