// A family of scattering models as a fit sees it: a vector of unknowns with bounds and starts, and the shading of
// recorded light paths with its slopes. There are five: the thread model (the default); a thread described by its
// fibers; and, to compare with, a single fiber, a yarn aggregated analytically, and the thread model as the paper fits
// it.
//
//   family | unknowns | what they are
//   thread | 16 or 18 | thread_unknowns.h; the latter with the tint of its highlight
//   fiber  | 5        | sigma_a (R G B, per thread radius), beta_m, beta_n; index of refraction 1.55
//   yarn   | 6        | sigma_a (R G B, per thread radius), beta_r, beta_tt, gamma_tt; the number of fibers is given
//   bundle | 5        | sigma_a (R G B, per fiber radius), beta_m, beta_n of a fiber; index of refraction 1.55; the
//          |          | number of fibers and how densely they are packed are given
//   paper  | 16       | the thread's parameters as printed (renderer/scattering/thread.h); energies may be negative,
//          |          | and light leaves where it came in
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <variant>
#include <vector>

#include "inversion/fit/block_estimate.h"
#include "inversion/fit/thread_unknowns.h"
#include "renderer/scene/scene.h"

namespace ceres {
class Problem;
}

namespace inversion {

struct ThreadFamily {
  // Given, not unknown.
  renderer::ThreadExit exit = renderer::ThreadParameters{}.exit;
  std::array<double, 2> transmittance_powers = renderer::ThreadParameters{}.transmittance_powers;
  bool tinted = false;  // whether the tint of its highlight is unknown; 1 otherwise
};
struct FiberFamily {};
struct YarnFamily {
  int fiber_count;
};
struct PaperFamily {};
struct BundleFamily {
  int fiber_count;
  double packing;  // share of the thread's cross-section that its fibers fill
};
using ScatteringFamily = std::variant<ThreadFamily, FiberFamily, YarnFamily, PaperFamily, BundleFamily>;

struct FamilyUnknowns {
  std::vector<std::string> names;
  Eigen::VectorXd lower, upper;              // bounds
  std::vector<Eigen::VectorXd> starts;       // the first is the default
  std::vector<int> azimuthal_roughnesses{};  // indices: step_coordinates.h
};
FamilyUnknowns unknowns_of(const ScatteringFamily& family);

renderer::ScatteringModel model_at(const ScatteringFamily& family, const Eigen::VectorXd& unknowns);

// Adds what the loss asks for besides agreement with the views; `unknowns` is the problem's only parameter block.
// Threads pay for lobes' energies whose sum exceeds 1 at some angle, and for lambda_0(1) > lambda_0(0) [Xia 2025,
// eq. 6]; the paper's thread pays the three hinges of eq. 6 alone.
void add_penalties(const ScatteringFamily& family, ceres::Problem& problem, double* unknowns,
                   bool with_energies = true);

// What threads pay for energies: half the square of each `excess` that is positive.
struct EnergyLimits {
  Eigen::VectorXd excess;  // of the sum over 1 at some angles, times the root of what it costs; other families: none
  Eigen::MatrixXd rows;    // angles x unknowns: its derivatives
};
EnergyLimits energy_limits(const ScatteringFamily& family, const Eigen::VectorXd& unknowns);

// A family's model at some unknowns, prepared to shade blocks.
struct ThreadShader {
  BlockModel model;
  // The 16 parameters, then lambda0_rgb, by the unknowns.
  Eigen::Matrix<double, renderer::kThreadParameterCount + 3, Eigen::Dynamic> parameters_by_unknowns;
};
using BlockShader = std::variant<ThreadShader, FiberBlockModel, YarnBlockModel>;
BlockShader shader_at(const ScatteringFamily& family, const Eigen::VectorXd& unknowns);
BlockEstimate shade(const BlockShader& shader, const LightPaths& paths, std::size_t block, bool with_slopes);
// A block's slopes by the unknowns: RGB x unknowns.
Eigen::Matrix<double, 3, Eigen::Dynamic> by_unknowns(const BlockShader& shader,
                                                     const renderer::ThreadSlopes<double>& slopes);

// The start that no thread is far from: grey, half rough, reflecting a third and passing a third of the light.
renderer::ThreadParameters starting_thread();
// Further starts, as the loss has local minima where the lobes have changed roles: a clearer thread with lobes of like
// width, a darker one with a narrow reflection.
std::vector<renderer::ThreadParameters> other_starting_threads();
// The start of a metallic thread, whose light comes back from its surface: one beside the others where the highlight
// may be tinted.
renderer::ThreadParameters metallic_starting_thread();

// The numbers of fibers that a yarn is fitted with; the best fit is kept [Xia 2025, section 6: the model needs one
// given].
inline constexpr std::array<int, 5> kYarnFiberCounts{5, 10, 20, 40, 80};
// The share of a yarn's cross-section that its fibers fill.
inline constexpr double kYarnPacking = 0.45;

// What a bundle is fitted with; the best fit is kept. The first packing is as dense as random placement gets.
inline constexpr std::array<int, 5> kBundleFiberCounts{5, 10, 20, 40, 80};
inline constexpr std::array<double, 4> kBundlePackings{0.45, 0.38, 0.3, 0.2};

}  // namespace inversion
