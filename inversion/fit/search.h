// What the parts of a fit share: what is searched, how far one search has come, and how much of the work is done.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "inversion/fit/effort.h"
#include "inversion/fit/view_fit.h"
#include "inversion/fit/view_objective.h"

namespace inversion {

// What is searched, and how. What it points at must outlive it.
struct Search {
  const ScatteringFamily* family;
  const FitOptions* options;
  Effort effort;
  FamilyUnknowns unknowns;
  std::vector<int> held;  // indices of unknowns

  // The prior is one of simulated threads, whose highlight has no tint.
  bool has_prior() const { return options->model == ModelKind::thread && !options->tinted; }
};

// One search from one start, round after round.
struct Attempt {
  int start = 0;  // its number
  Eigen::VectorXd unknowns;
  std::vector<FitRound> rounds{};
  double prior_scale = 0;              // of ThreadPriorTerm, in the last round
  std::vector<double> view_weights{};  // robust_weights.h; empty: 1
  // How the unknowns would spread over other noise; empty: as Levenberg-Marquardt's last round says.
  Eigen::MatrixXd covariance{};

  double loss() const { return rounds.empty() ? 0 : rounds.back().loss_after; }
};

// Where a colour is absorbed so strongly that nothing of it comes through, no view says how strongly, and a search that
// got there by one long step would never come back: it goes on from where some of the colour is seen.
void lighten_blackest(const Search& search, Eigen::VectorXd& unknowns);

// How much of a fit is done, in any unit. Asks FitOptions::progress, which may stop it.
class Work {
 public:
  Work(const FitOptions& options, double whole) : options_(options), whole_(whole) {}
  // Says what is done and that `part` of the next piece is; false: the fit is to stop.
  bool goes_on(const std::string& what, double part);
  // The same; throws std::runtime_error when the fit is to stop.
  void show(const std::string& what, double part);
  void finish(double piece) { done_ += piece; }
  void drop(double piece) { whole_ -= piece; }  // that needs not be done
  void add(double piece) { whole_ += piece; }   // that nobody expected; what is said to be done waits for it

 private:
  const FitOptions& options_;
  double whole_, done_ = 0;
  double said_ = 0;  // the greatest share
};

[[noreturn]] void throw_stopped();

// The seed of a fit's traces by their number. Those below 0 compare searches.
std::uint64_t seed_of_trace(const FitOptions& options, int number);

// NoiseWeights' groups of the objective's residuals.
std::vector<int> views_and_colours(const ViewObjective& objective);

}  // namespace inversion
