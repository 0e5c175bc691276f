#include "inversion/fit/search.h"

#include <algorithm>
#include <stdexcept>

namespace inversion {

void lighten_blackest(const Search& search, Eigen::VectorXd& unknowns) {
  constexpr double kBlackest = 3;  // for each radius
  for (int k = kSigma; k < kSigma + 3; ++k)
    if (std::find(search.held.begin(), search.held.end(), k) == search.held.end())
      unknowns[k] = std::min(unknowns[k], kBlackest);
}

bool Work::goes_on(const std::string& what, double part) {
  said_ = std::clamp((done_ + part) / whole_, said_, 1.0);
  return !options_.progress || options_.progress(what, said_);
}

void Work::show(const std::string& what, double part) {
  if (!goes_on(what, part)) throw_stopped();
}

void throw_stopped() {
  throw std::runtime_error("the fit was stopped on request; start it again for a thread");
}

std::uint64_t seed_of_trace(const FitOptions& options, int number) {
  return options.seed + static_cast<std::uint64_t>(std::int64_t{kFitSeedStep} * number);
}

std::vector<int> views_and_colours(const ViewObjective& objective) {
  std::vector<int> groups = objective.residual_views();
  for (std::size_t i = 0; i < groups.size(); ++i) groups[i] = 3 * groups[i] + static_cast<int>(i % 3);
  return groups;
}

}  // namespace inversion
