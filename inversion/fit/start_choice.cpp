#include "inversion/fit/start_choice.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "inversion/fit/noise_weights.h"
#include "inversion/fit/thread_unknowns.h"
#include "inversion/fit/unbiased_steps.h"

namespace inversion {
namespace {

using Eigen::VectorXd;

constexpr int kApproachSteps = 8, kJointSteps = 2, kSteps = kApproachSteps + kJointSteps;
constexpr int kComparedSets = 4, kComparedPaths = 2048;  // for each block
constexpr int kMostStride = 3;                           // of blocks
constexpr std::size_t kFewestBlocks = 100;               // that are left of them
constexpr int kFirstTrace = 1000;                        // of the steps, apart from those of the fit's end

bool is_thread(const Search& search) {
  return std::holds_alternative<ThreadFamily>(*search.family);
}

int stride_of(std::size_t blocks) {
  return std::clamp(static_cast<int>(blocks / kFewestBlocks), 1, kMostStride);
}

int paths_of_step(const FitOptions& options) {
  return std::max(kFewestPathsWithoutBias, options.paths_per_block.back() / 2);
}

class StartChoice {
 public:
  StartChoice(const WrappedSpool& spool, const std::vector<View>& views, const Search& search, int stride, Work& work)
      : objective_(spool, views, *search.family, stride),
        options_(*search.options),
        brief_(search),
        work_of_path_(1.0 / stride),
        work_(work) {
    options_.paths_per_block.back() = paths_of_step(*search.options);
    brief_.options = &options_;
    brief_.effort.approach_steps = kApproachSteps, brief_.effort.joint_steps = kJointSteps;
    brief_.effort.robust = false;  // weights that differ between searches would compare what each cannot explain
  }

  void go_on(Attempt& attempt, const std::string& name) {
    const double work_of_step = work_of_path_ * options_.paths_per_block.back();
    const auto show = [&](int step) {
      work_.show(name + ", step " + std::to_string(step + 1) + " of " + std::to_string(kSteps), step * work_of_step);
    };
    lighten_blackest(brief_, attempt.unknowns);
    objective_.trace(attempt.unknowns, options_.paths_per_block.back(), seed_of_trace(options_, kFirstTrace - 1),
                     [&](int, int) { show(0); });
    UnbiasedEnd end = remove_bias(objective_, brief_, kFirstTrace, show, attempt);
    attempt.covariance =
        certainty_at(objective_, brief_, end.prior_scale, attempt.unknowns, std::move(end)).noise_covariance;
    work_.finish(kSteps * work_of_step);
  }

  // The number of the attempt whose misfit is least.
  std::size_t nearest(const std::vector<Attempt>& attempts) {
    for (std::size_t i = seen_.size(); i < attempts.size(); ++i) seen_.push_back(seen(attempts[i].unknowns));
    NoiseWeights weights(views_and_colours(objective_));
    for (const Seen& one : seen_) weights.add(one.variances, one.products);
    const VectorXd squares = weights.factors().cwiseAbs2();
    const auto misfit = [&](const Seen& one) { return one.products.dot(squares); };
    const auto nearest = std::min_element(seen_.begin(), seen_.end(),
                                          [&](const Seen& a, const Seen& b) { return misfit(a) < misfit(b); });
    return static_cast<std::size_t>(nearest - seen_.begin());
  }

 private:
  // An attempt by paths that none has seen, as NoiseWeights takes it.
  struct Seen {
    VectorXd variances, products;
  };

  // The products are those of all pairs of halves of all sets of paths, whose noise falls with the number of sets, and
  // not with its root as that of each set's own halves.
  Seen seen(const VectorXd& unknowns) {
    const VectorXd zero = VectorXd::Zero(objective_.residual_count());
    VectorXd variances = zero, sum = zero, squares = zero;
    for (int set = 1; set <= kComparedSets; ++set) {
      objective_.trace(unknowns, kComparedPaths, seed_of_trace(options_, -set),
                       [&](int, int) { work_.show("comparing starts", 0); });
      const ViewObjective::Halves both = objective_.halves(unknowns, false);
      variances += both.variances / kComparedSets;
      for (const VectorXd& half : both.residuals) sum += half, squares += half.cwiseAbs2();
      work_.finish(kComparedPaths * work_of_path_);
    }
    constexpr double kHalves = 2.0 * kComparedSets;
    return {.variances = variances,
            .products = (sum.cwiseAbs2() - squares) / (kHalves * (kHalves - 1)) - objective_.photograph_variances()};
  }

  ViewObjective objective_;
  FitOptions options_;
  Search brief_;
  double work_of_path_;
  Work& work_;
  std::vector<Seen> seen_;
};

}  // namespace

Attempt nearest_search(const WrappedSpool& spool, const std::vector<View>& views, std::size_t blocks,
                       const Search& search, std::vector<Attempt> attempts, Work& work) {
  StartChoice choice(spool, views, search, stride_of(blocks), work);
  if (!is_thread(search)) return std::move(attempts[choice.nearest(attempts)]);
  for (Attempt& attempt : attempts) choice.go_on(attempt, "start " + std::to_string(attempt.start + 1));
  Attempt exchanged = attempts[choice.nearest(attempts)];
  std::swap(exchanged.unknowns[kAlpha], exchanged.unknowns[kAlpha + 2]);
  choice.go_on(exchanged, "R and TRT exchanged");
  attempts.push_back(std::move(exchanged));
  return std::move(attempts[choice.nearest(attempts)]);
}

double work_of_choice(const Search& search, std::size_t blocks, std::size_t attempts) {
  const double compared = kComparedSets * kComparedPaths, steps = kSteps * paths_of_step(*search.options);
  const auto searches = static_cast<double>(attempts);
  return (is_thread(search) ? (searches + 1) * (steps + compared) : searches * compared) / stride_of(blocks);
}

}  // namespace inversion
