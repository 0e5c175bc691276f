#include "inversion/fit/view_objective.h"

#include <gtest/gtest.h>

#include "inversion/fit/thread_unknowns.h"
#include "tests/inversion/fit/synthetic_spool.h"

namespace inversion {
namespace {

using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Case {
  const char* name;
  ScatteringFamily family;
};

class ViewObjectiveTest : public testing::TestWithParam<Case> {
 protected:
  static const std::vector<View>& views() {
    static const std::vector<View> made = [] {
      std::vector<View> all;
      for (int i : {0, 3, 4}) {
        all.push_back(unlit_view(kSpool, six_standpoints()[static_cast<std::size_t>(i)], 48));
        all.back().image = cv::Mat3f(all.back().mask.size(), cv::Vec3f(1, 1, 1));
      }
      return all;
    }();
    return made;
  }
  inline static const WrappedSpool kSpool{};
};

// Common paths: the differences are those of one deterministic function. Floats limit them: 1e-4 of a residual over
// the step.
TEST_P(ViewObjectiveTest, GradientsOfTheLossAgreeWithFiniteDifferences) {
  const ScatteringFamily& family = GetParam().family;
  ViewObjective objective(kSpool, views(), family);
  for (const VectorXd& start : unknowns_of(family).starts) {
    objective.trace(start, 128, 3, [](int, int) {});
    const Eigen::Index unknowns = start.size();
    VectorXd residuals(objective.residual_count()), beside(objective.residual_count());
    RowMajor jacobian(objective.residual_count(), unknowns);
    objective.residuals(start, residuals.data(), jacobian.data());
    const VectorXd gradient = jacobian.transpose() * residuals;
    for (Eigen::Index k = 0; k < unknowns; ++k) {
      const double step = 1e-2 * std::max(0.1, std::abs(start[k]));
      const auto loss_at = [&](double change) {
        VectorXd moved = start;
        moved[k] += change;
        objective.residuals(moved, beside.data(), nullptr);
        return 0.5 * beside.squaredNorm();
      };
      // Fifth order: large steps keep the rounding of floats small.
      const double difference =
          (8 * (loss_at(step) - loss_at(-step)) - (loss_at(2 * step) - loss_at(-2 * step))) / (12 * step);
      EXPECT_NEAR(gradient[k], difference, 1e-3 * std::abs(gradient[k]) + 1e-5 * gradient.cwiseAbs().maxCoeff())
          << unknowns_of(family).names[static_cast<std::size_t>(k)];
    }
  }
}

TEST_P(ViewObjectiveTest, ResidualVariancesAreTheSpreadOfResidualsOverSeeds) {
  const ScatteringFamily& family = GetParam().family;
  ViewObjective objective(kSpool, views(), family);
  const VectorXd at = unknowns_of(family).starts.front();
  VectorXd sum = VectorXd::Zero(objective.residual_count()), squares = sum, variances = sum, now = sum;
  constexpr int kSeeds = 60;
  for (int seed = 0; seed < kSeeds; ++seed) {
    objective.trace(at, 64, 1000 + static_cast<std::uint64_t>(seed), [](int, int) {});
    objective.residuals(at, now.data(), nullptr);
    sum += now, squares += now.cwiseAbs2(), variances += objective.residual_variances(at) / kSeeds;
  }
  const VectorXd observed = (squares - sum.cwiseAbs2() / kSeeds) / (kSeeds - 1);
  // Heavy tails: few blocks have most of the variance.
  EXPECT_NEAR(observed.sum() / variances.sum(), 1, 0.25);
}

TEST_P(ViewObjectiveTest, APhotographsVarianceAddsToItsResiduals) {
  const ScatteringFamily& family = GetParam().family;
  std::vector<View> noisy = views();
  for (View& view : noisy) view.noise = NoiseLaw{.floor = Eigen::Array3d::Constant(4)};
  ViewObjective plain(kSpool, views(), family), with(kSpool, noisy, family);
  const VectorXd at = unknowns_of(family).starts.front();
  for (ViewObjective* objective : {&plain, &with}) objective->trace(at, 16, 3, [](int, int) {});
  const VectorXd added = with.residual_variances(at) - plain.residual_variances(at);
  // weight^2 4 / n / diffuser^2 with weight^2 = 2 n / masked pixels: the same for all blocks of a view.
  const double diffuser = diffuser_radiance(noisy[0].light).mean();
  EXPECT_NEAR(added[0], 2.0 * 4 / (cv::countNonZero(noisy[0].mask) * diffuser * diffuser), 1e-9 * added[0]);
  EXPECT_GT(added.minCoeff(), 0);
}

INSTANTIATE_TEST_SUITE_P(Families, ViewObjectiveTest,
                         testing::Values(Case{"thread", ThreadFamily{}}, Case{"tinted", ThreadFamily{.tinted = true}},
                                         Case{"fiber", FiberFamily{}}, Case{"yarn", YarnFamily{20}},
                                         Case{"paper", PaperFamily{}}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace inversion
