#include "renderer/scattering/multi_fiber.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "renderer/scattering/azimuthal_profile.h"
#include "renderer/scattering/circle_grid.h"
#include "renderer/scattering/degree.h"
#include "renderer/scattering/lobes.h"
#include "tests/renderer/scattering/plain_circle_tracer.h"

namespace renderer {
namespace {

double integral(const MultiFiberScattering& s) {
  return std::accumulate(s.density.begin(), s.density.end(), 0.0) * 2 * std::numbers::pi /
         static_cast<double>(s.density.size());
}

TEST(MultiFiberTest, WithoutAbsorptionNoEnergyIsLost) {
  for (double theta_deg : {0.0, 45.0, 85.0, 89.5}) {
    const MultiFiberScattering s =
        simulate_multi_fiber({.theta_rad = theta_deg * kDegree, .rays = 2000, .configurations = 20});
    EXPECT_NEAR(s.albedo, 1, 1e-9) << theta_deg;
    EXPECT_NEAR(integral(s), 1, 1e-9) << theta_deg;
  }
}

TEST(MultiFiberTest, FractionsByFibersPassedSumToTheAlbedo) {
  const MultiFiberScattering s = simulate_multi_fiber({.sigma_a = 0.1, .rays = 2000, .configurations = 20});
  EXPECT_NEAR(std::accumulate(s.by_fibers_passed.begin(), s.by_fibers_passed.end(), 0.0), s.albedo, 1e-12);
  EXPECT_GT(s.by_fibers_passed[0], 0.02) << "some light is only reflected";
}

TEST(MultiFiberTest, OneFiberAsThickAsTheThreadIsTheAnalyticSingleCircle) {
  for (double theta : {0.0, 50 * kDegree, 80 * kDegree})
    for (double sigma : {0.0, 0.3}) {
      const MultiFiberOptions options{
          .thread_radius = 1, .sigma_a = sigma, .theta_rad = theta, .rays = 2000000, .configurations = 1, .bins = 60};
      const MultiFiberScattering found = simulate_multi_fiber(options);
      Eigen::ArrayXd expected = Eigen::ArrayXd::Zero(options.bins);
      for (int p = 0; p < 30; ++p) expected += smooth_fiber_lobe(p, theta, options.eta, sigma, options.bins);
      EXPECT_EQ(found.miss, 0);
      for (Eigen::Index i = 0; i < expected.size(); ++i) {
        // Five standard errors of counting; a bin holds fraction = density * width of all rays.
        const double width = 2 * std::numbers::pi / options.bins;
        const double error = std::sqrt(expected[i] / width / options.rays);
        EXPECT_NEAR(found.density[static_cast<std::size_t>(i)], expected[i], 5 * error + 1e-4)
            << "bin " << i << " theta " << theta;
      }
    }
}

TEST(MultiFiberTest, AgreesWithTracingEverySegmentAgainstEveryCircle) {
  for (double theta_deg : {0.0, 70.0})
    for (double sigma : {0.0, 0.1}) {
      const MultiFiberOptions options{
          .sigma_a = sigma, .theta_rad = theta_deg * kDegree, .rays = 4000, .configurations = 60, .bins = 12};
      const MultiFiberScattering fast = simulate_multi_fiber(options), plain = trace_circles_plainly(options);
      // The same configurations; 240 000 rays each: the standard error of a fraction is at most 0.001.
      EXPECT_NEAR(fast.miss, plain.miss, 0.003);
      EXPECT_NEAR(fast.albedo, plain.albedo, 0.005);
      EXPECT_NEAR(fast.back, plain.back, 0.005);
      if (sigma == 0) EXPECT_NEAR(fast.mean_entered / plain.mean_entered, 1, 0.01);
      for (std::size_t i = 0; i < fast.density.size(); ++i)
        EXPECT_NEAR(fast.density[i], plain.density[i], 0.007) << "bin " << i;  // five errors of 0.0014
    }
}

// An earlier program's figures for R = 10, r = 1, gap 0.1, 1000 attempts, eta 1.5, +-0.004.
struct ReferenceRow {
  double theta_deg, back_clear, albedo_03, albedo_1, albedo_3;
};
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr ReferenceRow kReference[] = {
    {0, .314, .801, .506, .187},  {15, .321, .798, .501, .184}, {30, .349, .789, .487, .180},
    {45, .408, .775, .470, .180}, {60, .515, .763, .470, .209}, {70, .610, .762, .495, .267},
    {75, .660, .767, .525, .321}, {80, .713, .779, .573, .405}, {85, .769, kNone, .658, kNone}};

TEST(MultiFiberTest, ReproducesTheReferenceFractions) {
  const auto simulated = [](double theta_deg, double sigma) {
    return simulate_multi_fiber({.placement = FiberPlacement::radius_uniform,
                                 .sigma_a = sigma,
                                 .theta_rad = theta_deg * kDegree,
                                 .rays = 4000,
                                 .configurations = 150});
  };
  constexpr double kTolerance = 0.006;  // their +-0.004 and our configurations' 0.002
  for (const ReferenceRow& row : kReference) {
    EXPECT_NEAR(simulated(row.theta_deg, 0).back, row.back_clear, kTolerance) << row.theta_deg;
    for (const auto& [sigma, albedo] :
         {std::pair{0.03, row.albedo_03}, std::pair{0.1, row.albedo_1}, std::pair{0.3, row.albedo_3}})
      if (!std::isnan(albedo))
        EXPECT_NEAR(simulated(row.theta_deg, sigma).albedo, albedo, kTolerance) << row.theta_deg << ' ' << sigma;
  }
}

TEST(MultiFiberTest, TheResultDependsOnTheSeedAndNotOnTheThreads) {
  MultiFiberOptions options{.sigma_a = 0.1, .rays = 40000, .configurations = 7, .threads = 1};
  const MultiFiberScattering one = simulate_multi_fiber(options);
  options.threads = 2;
  const MultiFiberScattering two = simulate_multi_fiber(options);
  EXPECT_EQ(one.density, two.density);
  EXPECT_EQ(one.mean_length, two.mean_length);
  options.seed = 2;
  EXPECT_NE(simulate_multi_fiber(options).density, one.density);
}

TEST(MultiFiberTest, PredictedErrorsMatchTheSpreadOverSeeds) {
  constexpr int kRuns = 60, kBins = 12;
  std::vector<double> sum(kBins), squares(kBins), predicted(kBins);
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const MultiFiberScattering s =
        simulate_multi_fiber({.rays = 500, .configurations = 40, .bins = kBins, .seed = seed});
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += s.density[i], squares[i] += s.density[i] * s.density[i];
      predicted[i] += s.density_error[i] * s.density_error[i];
    }
  }
  double ratio = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double mean = sum[i] / kRuns;
    ratio += (squares[i] / kRuns - mean * mean) * kRuns / (kRuns - 1) / (predicted[i] / kRuns) / kBins;
  }
  EXPECT_NEAR(ratio, 1, 0.25);  // 12 variances of 60 runs each: standard error some 0.06; weights vary a little
}

TEST(MultiFiberTest, SmallerFibersScatterLessForwardAndMoreBack) {
  double back = 0;
  for (double radius : {5.0, 2.0, 1.0, 0.5}) {
    const double now =
        simulate_multi_fiber({.fiber_radius = radius, .min_gap = 0.1 * radius, .rays = 2000, .configurations = 60})
            .back;
    EXPECT_GT(now, back + 0.02) << radius;
    back = now;
  }
}

TEST(MultiFiberTest, TouchingFibersAndManyFibersAreFine) {
  const MultiFiberScattering dense = simulate_multi_fiber(
      {.fiber_radius = 0.1, .min_gap = 0, .max_attempts = 20000, .rays = 500, .configurations = 2});
  EXPECT_GT(dense.mean_fibers, 3000);
  EXPECT_NEAR(dense.albedo, 1, 1e-9);
}

TEST(MultiFiberTest, IsStoppedByProgress) {
  MultiFiberOptions options{.rays = 2000, .configurations = 200};
  double last = 0;
  options.progress = [&](double fraction) {
    EXPECT_GT(fraction, 0);
    EXPECT_LE(fraction, 1);
    last = fraction;
    return true;
  };
  simulate_multi_fiber(options);
  EXPECT_GT(last, 0.5);
  options.progress = [](double) { return false; };
  EXPECT_THROW(simulate_multi_fiber(options), std::runtime_error);
}

TEST(MultiFiberTest, RefusesWhatCannotBe) {
  EXPECT_THROW(simulate_multi_fiber({.thread_radius = 1, .fiber_radius = 2}), std::invalid_argument);
  EXPECT_THROW(simulate_multi_fiber({.min_gap = -1}), std::invalid_argument);
  EXPECT_THROW(simulate_multi_fiber({.eta = 1}), std::invalid_argument);
  EXPECT_THROW(simulate_multi_fiber({.sigma_a = -1}), std::invalid_argument);
  EXPECT_THROW(simulate_multi_fiber({.theta_rad = std::numbers::pi / 2}), std::invalid_argument);
  EXPECT_THROW(simulate_multi_fiber({.rays = 0}), std::invalid_argument);
  EXPECT_THROW(simulate_multi_fiber({.bins = 3}), std::invalid_argument);
}

TEST(CircleGridTest, FindsTheCircleThatALoopOverAllFinds) {
  const std::vector<Eigen::Vector2d> centers = pack_fibers(10, 0.7, 0.05, 2000, 500, 3);
  const CircleGrid grid(centers, 0.7, 10);
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  int hits = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Eigen::Vector2d origin(10 * unit(engine), 10 * unit(engine));
    const double turn = std::numbers::pi * unit(engine);
    const Eigen::Vector2d direction =
        trial % 100 ? Eigen::Vector2d(std::cos(turn), std::sin(turn)) : Eigen::Vector2d(0, 1);
    CircleHit expected{-1, std::numeric_limits<double>::infinity()};
    bool inside = false;
    for (int i = 0; i < static_cast<int>(centers.size()); ++i) {
      const Eigen::Vector2d to = centers[static_cast<std::size_t>(i)] - origin;
      inside |= to.norm() < 0.7;
      const double along = to.dot(direction), half2 = 0.49 - (to.squaredNorm() - along * along);
      if (along > 0 && half2 > 0 && along - std::sqrt(half2) < expected.distance)
        expected = {i, along - std::sqrt(half2)};
    }
    if (inside) continue;
    const CircleHit found = grid.nearest(origin, direction, -1);
    EXPECT_EQ(found.circle, expected.circle) << origin.transpose() << " to " << direction.transpose();
    hits += found.circle >= 0;
  }
  EXPECT_GT(hits, 3000);
}

}  // namespace
}  // namespace renderer
