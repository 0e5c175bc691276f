#include "renderer/scattering/thread_prior.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

namespace renderer {
namespace {

TEST(ThreadPriorTest, ItsCovarianceIsThatAmongTheThreadsAndTheirFitsOwn) {
  LibraryFit a{}, b{};
  a.covariance(3, 3) = 1, b.covariance(0, 3) = b.covariance(3, 0) = 6;
  a.unknowns[0] = 1, a.unknowns[3] = 2;
  b.unknowns[0] = 3, b.unknowns[3] = -2;
  const ThreadPrior prior = prior_of({a, b});
  EXPECT_EQ(prior.threads, 2);
  EXPECT_DOUBLE_EQ(prior.mean[0], 2);
  EXPECT_DOUBLE_EQ(prior.covariance(0, 0), 2);
  EXPECT_DOUBLE_EQ(prior.covariance(0, 3), -4 + 3);
  EXPECT_DOUBLE_EQ(prior.covariance(3, 3), 8 + 0.5);
  EXPECT_THROW(prior_of({a}), std::invalid_argument);
}

TEST(ThreadPriorTest, TheBuiltInPriorIsADistributionOverPossibleThreads) {
  const ThreadPrior& prior = simulated_thread_prior();
  EXPECT_EQ(prior.threads, static_cast<int>(thread_library().size()));
  EXPECT_LT((prior.covariance - prior.covariance.transpose()).norm(), 1e-12);
  const Eigen::SelfAdjointEigenSolver<PriorMatrix> eigen(prior.covariance);
  EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-6);  // six digits are stored
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(prior.mean[i] > 0.02 && prior.mean[i] < 1) << "a roughness";
  ThreadParameters mean;
  set_energies(prior.mean.data() + 3, mean);
  mean.limit_energy = false;
  for (double c : {0.2, 0.6, 1.0})
    for (double lambda : thread_lobe_energies<double>(mean, c)) EXPECT_TRUE(lambda >= 0 && lambda < 1.5) << c;
}

TEST(ThreadPriorTest, AThreadOfTheLibraryIsFittedAgainAsItStandsThere) {
  const LibraryThread coarse{0.2, 1.53, 0.3, {0, 0, 0}};
  int asked = 0;
  PriorOptions options{.rays = 500, .configurations = 60};
  options.progress = [&](int done, int total) {
    EXPECT_EQ(done, asked++);
    EXPECT_EQ(total, 1);
    return true;
  };
  const LibraryFit fit = fit_library({coarse}, options).front();
  EXPECT_LT(fit.error, 0.2);
  EXPECT_GT(fit.unknowns[6], 0.3) << "r1a: coarse white fibers let most light through";
  options.progress = [](int, int) { return false; };
  EXPECT_THROW(fit_library({coarse}, options), std::runtime_error);
}

}  // namespace
}  // namespace renderer
