// A family of scattering models as a fit sees it: a vector of unknowns with bounds and starts, and the shading of recorded
// light paths with its slopes. Three of them: the thread model (default) and, to compare it with, a single fiber and a
// yarn aggregated analytically.
//
//   family | unknowns | what they are
//   thread | 16       | thread_unknowns.h
//   fiber  | 5        | sigma_a (R G B, per thread radius), beta_m, beta_n; index of refraction 1.55
//   yarn   | 6        | sigma_a (R G B, per thread radius), beta_r, beta_tt, gamma_tt; a number of fibers that is not varied
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "inversion/block_estimate.h"
#include "renderer/scene.h"

namespace ceres {
class Problem;
}

namespace inversion {

class BlockShader {
 public:
  virtual ~BlockShader() = default;
  virtual BlockEstimate shade(const LightPaths& paths, std::size_t block, bool with_slopes) const = 0;
  // A block's slopes by the unknowns, RGB x unknowns.
  virtual Eigen::Matrix<double, 3, Eigen::Dynamic> by_unknowns(
      const renderer::ThreadSlopes<double>& slopes) const = 0;
};

class ScatteringFamily {
 public:
  virtual ~ScatteringFamily() = default;
  virtual std::string name() const = 0;
  virtual std::vector<std::string> unknown_names() const = 0;
  virtual Eigen::VectorXd lower_bounds() const = 0;
  virtual Eigen::VectorXd upper_bounds() const = 0;
  virtual std::vector<Eigen::VectorXd> starts() const = 0;  // the first is the default's
  virtual renderer::ScatteringModel model(const Eigen::VectorXd& unknowns) const = 0;
  virtual std::unique_ptr<BlockShader> shader(const Eigen::VectorXd& unknowns) const = 0;
  // What the loss asks for besides agreement with the views; `unknowns` is the problem's only parameter block.
  virtual void add_penalties(ceres::Problem& problem, double* unknowns) const;

  int unknown_count() const { return static_cast<int>(lower_bounds().size()); }
};

// A start that no thread is far from: grey, half rough, reflecting a third and passing a third of the light.
renderer::ThreadParameters starting_thread();
// The loss has local minima where the lobes have changed roles; others from which the search starts as well: clearer
// with lobes of like width, darker with a narrow reflection.
std::vector<renderer::ThreadParameters> other_starting_threads();

// Penalties: lobes' energies whose sum exceeds 1 at some angle, and eq. 6's preference for lambda_0(1) <= lambda_0(0)
// [Xia 2025].
std::unique_ptr<ScatteringFamily> thread_family();
std::unique_ptr<ScatteringFamily> fiber_family();
std::unique_ptr<ScatteringFamily> yarn_family(int fiber_count);

// Numbers of fibers that a yarn is tried with, the best to be kept [Xia 2025, section 6: the model needs one given].
inline constexpr std::array<int, 5> kYarnFiberCounts{5, 10, 20, 40, 80};
// Of a yarn's cross-section: threads are packed so.
inline constexpr double kYarnPacking = 0.45;

}  // namespace inversion
