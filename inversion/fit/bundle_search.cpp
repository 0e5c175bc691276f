#include "inversion/fit/bundle_search.h"

#include <algorithm>

#include "inversion/fit/fit_family.h"
#include "inversion/fit/independent_loss.h"

namespace inversion {
namespace {

using Eigen::VectorXd;

// How far a bundle is fitted, and by how many paths it is compared with others.
struct Stage {
  std::vector<int> paths_per_block;  // of the rounds; the steps behind them take as many as the last
  Effort effort;
  int comparisons;  // relative_misfit, with as many paths each
};

const Stage kBrief{.paths_per_block = {64, 256, 1024},
                   .effort = {.block_stride = 3, .approach_steps = 1, .joint_steps = 2, .by_whole_hessian = true},
                   .comparisons = 3};
const Stage kLonger{
    .paths_per_block = {1024},
    .effort = {.rounds = false, .robust = false, .approach_steps = 1, .joint_steps = 1, .by_whole_hessian = true},
    .comparisons = 4};
constexpr Effort kToTheEnd{.rounds = false, .approach_steps = 1, .joint_steps = 5, .by_whole_hessian = true};
constexpr std::size_t kFinalists = 4;
constexpr double kShareOfBrief = 0.4, kShareOfLonger = 0.35;  // of the work; the rest is the last fit's

struct Candidate {
  BundleFamily bundle;
  VectorXd unknowns;
  double misfit;
};

bool explains_better(const Candidate& a, const Candidate& b) {
  return a.misfit < b.misfit;
}

class BundleSearch {
 public:
  BundleSearch(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options)
      : spool_(spool), views_(views), options_(options) {}

  ViewFit run() {
    std::vector<Candidate> candidates = fit_briefly();
    std::sort(candidates.begin(), candidates.end(), explains_better);
    candidates.resize(std::min(kFinalists, candidates.size()));
    for (Candidate& candidate : candidates)
      candidate = compared(candidate.bundle, kLonger, {candidate.unknowns}, kShareOfLonger / kFinalists);
    const Candidate& best = *std::min_element(candidates.begin(), candidates.end(), explains_better);
    return fit(best.bundle, {options_.paths_per_block.back()}, kToTheEnd, {best.unknowns},
               1 - kShareOfBrief - kShareOfLonger);
  }

 private:
  std::vector<Candidate> fit_briefly() {
    constexpr double kShare = kShareOfBrief / (kBundleFiberCounts.size() + 2 * (kBundlePackings.size() - 1));
    std::vector<Candidate> tried;
    const auto try_one = [&](std::size_t count, double packing) {
      const BundleFamily bundle{kBundleFiberCounts[count], packing};
      tried.push_back(compared(bundle, kBrief, unknowns_of(ScatteringFamily(bundle)).starts, kShare));
      return tried.back().misfit;
    };
    // From the count in the middle to the side that explains the views better, as far as that gets better.
    constexpr std::size_t kMiddle = kBundleFiberCounts.size() / 2;
    std::size_t count = kMiddle;
    double least = try_one(count, kBundlePackings.front());
    const auto gets_better = [&](std::size_t next) {
      if (next >= kBundleFiberCounts.size()) return false;
      const double misfit = try_one(next, kBundlePackings.front());
      if (misfit >= least) return false;
      least = misfit, count = next;
      return true;
    };
    while (count > 0 && gets_better(count - 1)) continue;
    if (count == kMiddle)
      while (gets_better(count + 1)) continue;
    // Fewer fibers that are packed densely look much like more of them that are not.
    for (std::size_t i = 1; i < kBundlePackings.size(); ++i)
      for (std::size_t more = count; more < std::min(count + 2, kBundleFiberCounts.size()); ++more)
        try_one(more, kBundlePackings[i]);
    return tried;
  }

  Candidate compared(const BundleFamily& bundle, const Stage& stage, const std::vector<VectorXd>& starts,
                     double share) {
    std::vector<int> paths = stage.paths_per_block;
    for (int& one : paths) one = std::min(one, options_.paths_per_block.back());
    const ViewFit found = fit(bundle, paths, stage.effort, starts, share);
    const double misfit = relative_misfit(spool_, views_, found, paths.back(), stage.comparisons,
                                          options_.seed + kFitSeedStep, stage.effort.block_stride);
    return {.bundle = bundle, .unknowns = found.unknowns, .misfit = misfit};
  }

  ViewFit fit(const BundleFamily& bundle, const std::vector<int>& paths, const Effort& effort,
              const std::vector<VectorXd>& starts, double share) {
    FitOptions one = options_;
    one.solver = Solver::levenberg_marquardt;
    one.paths_per_block = paths;
    if (options_.progress)
      one.progress = [&](const std::string& what, double done) {
        return options_.progress(std::to_string(bundle.fiber_count) + " fibers, " + what, done_ + done * share);
      };
    ViewFit found = fit_family(spool_, views_, one, bundle, starts, effort);
    done_ += share;
    return found;
  }

  const WrappedSpool& spool_;
  const std::vector<View>& views_;
  const FitOptions& options_;
  double done_ = 0;  // share of the work
};

}  // namespace

ViewFit fit_best_bundle(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options) {
  return BundleSearch(spool, views, options).run();
}

}  // namespace inversion
