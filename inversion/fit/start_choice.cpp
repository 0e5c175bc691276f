#include "inversion/fit/start_choice.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "inversion/fit/misfit_comparison.h"
#include "inversion/fit/thread_unknowns.h"
#include "inversion/fit/unbiased_steps.h"

namespace inversion {
namespace {

using Eigen::VectorXd;

constexpr int kApproachSteps = 8, kJointSteps = 2, kSteps = kApproachSteps + kJointSteps;
constexpr int kComparedSets = 4;
constexpr int kMostStride = 3;              // of blocks
constexpr std::size_t kFewestBlocks = 100;  // that are left of them
constexpr int kFirstTrace = 1000;           // of the steps, apart from those of the fit's end

bool is_thread(const Search& search) {
  return std::holds_alternative<ThreadFamily>(*search.family);
}

// A tint makes up for much at first: after ten steps in the right place a search may still be farther from the views
// than one that has come to rest in a wrong place.
int times_of(const Search& search) {
  return search.options->tinted ? 2 : 1;
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

  // So many times kSteps, each with paths of its own.
  void go_on(Attempt& attempt, const std::string& name, int times) {
    const double work_of_step = work_of_path_ * options_.paths_per_block.back();
    for (int behind = 0; behind < times * kSteps; behind += kSteps) {
      const auto show = [&](int step) {
        work_.show(name + ", step " + std::to_string(behind + step + 1) + " of " + std::to_string(times * kSteps),
                   step * work_of_step);
      };
      lighten_blackest(brief_, attempt.unknowns);
      objective_.trace(attempt.unknowns, options_.paths_per_block.back(),
                       seed_of_trace(options_, kFirstTrace + behind - 1), [&](int, int) { show(0); });
      UnbiasedEnd end = remove_bias(objective_, brief_, kFirstTrace + behind, show, attempt);
      attempt.covariance =
          certainty_at(objective_, brief_, end.prior_scale, attempt.unknowns, std::move(end)).noise_covariance;
      work_.finish(kSteps * work_of_step);
    }
  }

  void need_no_exchange() { work_.drop(kSteps * work_of_path_ * options_.paths_per_block.back()); }

  // Their numbers (MisfitComparison).
  std::vector<std::size_t> from_nearest(const std::vector<Attempt>& attempts) {
    MisfitComparison comparison(objective_, options_, kComparedSets);
    const auto show = [&] { work_.show("comparing starts", 0); };
    show();
    for (const Attempt& attempt : attempts)
      comparison.add(attempt.unknowns, [&] {
        work_.finish(MisfitComparison::kPaths * work_of_path_);
        show();
      });
    return comparison.from_nearest();
  }

 private:
  ViewObjective objective_;
  FitOptions options_;
  Search brief_;
  double work_of_path_;
  Work& work_;
};

// Whether a search that began where R and TRT had changed places, of which `before` says how they were, has kept them
// so.
bool keeps_exchanged(const VectorXd& unknowns, const VectorXd& before) {
  const Eigen::Vector2d now(unknowns[kAlpha], unknowns[kAlpha + 2]), was(before[kAlpha], before[kAlpha + 2]);
  return (now - was.reverse()).norm() < (now - was).norm();
}

}  // namespace

NearestSearch nearest_search(const WrappedSpool& spool, const std::vector<View>& views, std::size_t blocks,
                             const Search& search, std::vector<Attempt> attempts, Work& work) {
  StartChoice choice(spool, views, search, stride_of(blocks), work);
  if (is_thread(search))
    for (Attempt& attempt : attempts)
      choice.go_on(attempt, "start " + std::to_string(attempt.start + 1), times_of(search));
  const std::vector<std::size_t> order = choice.from_nearest(attempts);
  NearestSearch found{.nearest = attempts[order.front()]};
  if (!is_thread(search)) return found;
  // Under a tint a search that another start has led there is nearer than one that begins there.
  const auto lies_there = [&](std::size_t number) {
    return search.options->tinted && keeps_exchanged(attempts[number].unknowns, found.nearest.unknowns);
  };
  if (const auto other = std::ranges::find_if(order, lies_there); other != order.end()) {
    found.exchanged = attempts[*other];
    choice.need_no_exchange();
    return found;
  }
  Attempt exchanged = found.nearest;
  std::swap(exchanged.unknowns[kAlpha], exchanged.unknowns[kAlpha + 2]);
  choice.go_on(exchanged, "R and TRT exchanged", 1);
  if (keeps_exchanged(exchanged.unknowns, found.nearest.unknowns)) found.exchanged = std::move(exchanged);
  return found;
}

double work_of_choice(const Search& search, std::size_t blocks, std::size_t attempts) {
  const double compared = kComparedSets * MisfitComparison::kPaths, steps = kSteps * paths_of_step(*search.options);
  const auto searches = static_cast<double>(attempts);
  const double all_steps = is_thread(search) ? (searches * times_of(search) + 1) * steps : 0;
  return (searches * compared + all_steps) / stride_of(blocks);
}

}  // namespace inversion
