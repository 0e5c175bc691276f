// Which of several searches is nearest to the views, by paths that none of them has seen, all weighted by noise alike
// and without bias. The loss of eq. 6 does not tell: it is mostly the noise of the searches' own paths, which is least
// where lobes are wide.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "inversion/fit/search.h"
#include "inversion/fit/view_objective.h"

namespace inversion {

class MisfitComparison {
 public:
  static constexpr int kPaths = 2048;  // for each block, of a set

  // By so many sets of paths. The objective, which is left with paths of its own, outlives it.
  MisfitComparison(ViewObjective& objective, const FitOptions& options, int sets)
      : objective_(objective), options_(options), sets_(sets) {}
  // Traces the paths of one more search; calls step() after each set, and passes on what it throws.
  void add(const Eigen::VectorXd& unknowns, const std::function<void()>& step);
  // The searches, by their numbers in the order of adding, that of the least misfit first. Each misfit is taken as
  // large as its noise lets it be by one deviation: otherwise a search whose paths say little, in narrow lobes, would
  // be taken for the nearest by chance.
  std::vector<std::size_t> from_nearest() const;

 private:
  struct Seen {
    Eigen::VectorXd variances, products;  // as NoiseWeights takes them
    Eigen::VectorXd product_variances;    // as if a block's colours, which share its paths, had all the same noise
  };

  ViewObjective& objective_;
  const FitOptions& options_;
  int sets_;
  std::vector<Seen> seen_;
};

}  // namespace inversion
