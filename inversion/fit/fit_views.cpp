#include "inversion/fit/fit_views.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "inversion/fit/bundle_search.h"
#include "inversion/fit/fit_family.h"

namespace inversion {
namespace {

using Eigen::VectorXd;

ViewFit fit_best_yarn(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options) {
  std::optional<ViewFit> best;
  for (std::size_t i = 0; i < kYarnFiberCounts.size(); ++i) {
    FitOptions one = options;
    const std::string name = std::to_string(kYarnFiberCounts[i]) + " fibers, ";
    if (options.progress)
      one.progress = [&](const std::string& what, double share) {
        return options.progress(name + what, (static_cast<double>(i) + share) / kYarnFiberCounts.size());
      };
    const ScatteringFamily family = YarnFamily{kYarnFiberCounts[i]};
    ViewFit fit = fit_family(spool, views, one, family, unknowns_of(family).starts);
    if (!best || fit.loss() < best->loss()) best = std::move(fit);
  }
  return *std::move(best);
}

}  // namespace

ViewFit fit_views(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options) {
  const std::vector<int>& paths = options.paths_per_block;
  if (paths.empty() || *std::min_element(paths.begin(), paths.end()) < 1)
    throw std::invalid_argument("a fit was asked for without rounds or with a round without light paths");
  if (options.adam_steps < 1 || options.adam_paths < 1)
    throw std::invalid_argument("a fit by Adam was asked for without steps or without light paths");
  switch (options.model) {
    case ModelKind::yarn:
      return fit_best_yarn(spool, views, options);
    case ModelKind::bundle:
      return fit_best_bundle(spool, views, options);
    case ModelKind::paper:
      return fit_family(spool, views, options, PaperFamily{}, unknowns_of(PaperFamily{}).starts);
    case ModelKind::fiber:
      return fit_family(spool, views, options, FiberFamily{}, unknowns_of(FiberFamily{}).starts);
    case ModelKind::thread:
      break;
  }
  const auto start_at = [&](const renderer::ThreadParameters& start) {
    return options.tinted ? tinted_unknowns_of(start) : VectorXd(unknowns_of(start));
  };
  std::vector<VectorXd> starts{start_at(options.start)};
  if (options.held.empty())
    for (const renderer::ThreadParameters& start : options.other_starts) starts.push_back(start_at(start));
  if (options.tinted && starts.size() > 1) starts.push_back(start_at(metallic_starting_thread()));
  const ThreadFamily family{options.start.exit, options.start.transmittance_powers, options.tinted};
  return fit_family(spool, views, options, family, starts);
}

}  // namespace inversion
