#include "inversion/fit/nearest_fiber.h"

#include <ceres/ceres.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "renderer/picture/sampler.h"

namespace inversion {
namespace {

using Eigen::Array3d;
using Eigen::Matrix3d;
using renderer::BasicFiberParameters;
using renderer::FiberModel;
using renderer::FiberParameters;
using renderer::ThreadModel;
using renderer::ThreadParameters;
using Direction = renderer::Vec3<double>;

constexpr int kUnknowns = 6;  // eta, sigma_a (3), beta_m, beta_n
constexpr double kLeastIndex = 1.01, kMostAbsorption = 50, kLeastRoughness = 0.02;
// The weight of the squared relative errors of the albedo and of the light sent back; that of f_cos is 1.
constexpr double kEnergyWeight = 100;
constexpr std::array<std::array<double, kUnknowns>, 6> kStarts{{{1.55, 0.3, 0.3, 0.3, 0.3, 0.3},
                                                                {1.55, 0.3, 0.3, 0.3, 0.3, 0.6},
                                                                {1.55, 0.05, 0.05, 0.05, 0.6, 0.95},
                                                                {2.5, 0.3, 0.3, 0.3, 0.3, 0.3},
                                                                {2.5, 0.3, 0.3, 0.3, 0.3, 0.6},
                                                                {2.5, 1, 1, 1, 0.6, 0.95}}};

// How finely the integrals are sampled: midpoints of h in -1..1 and of sin theta_o in 0..1 (without a tilt the other
// half is the mirror image of this one), directions i for each theta_o.
struct Sampling {
  int offsets, inclinations, directions;
  std::uint64_t seed;
};
constexpr Sampling kForTheFit{12, 8, 80, 1}, kForTheReport{32, 16, 512, 2};

// The thread from one direction o: its values for every direction i and offset h, and its albedos.
struct View {
  Direction wo;
  double weight = 0;  // cos theta_o; all views together: 1
  std::vector<Direction> wi;
  std::vector<double> solid_angle;          // of each direction i: 1 / (density x count)
  std::vector<std::vector<Array3d>> f_cos;  // [i][h]
  std::vector<Array3d> albedo;              // [h]
  Array3d back = Array3d::Zero();           // of f_cos over the viewer's side, mean over h
};

struct Samples {
  std::vector<double> offsets;
  std::vector<View> views;
  double square = 0, square_far = 0, albedo_square = 0;  // of the thread, summed over the channels
};

// Whether a direction is on the viewer's side of the thread: direction o is at azimuth 0.
bool is_back(const Direction& wi) {
  return wi.y() > 0;
}

double midpoint(int i, int count, double low, double high) {
  return low + (high - low) * (i + 0.5) / count;
}

// Draws directions i: half from the thread's own lobes at any offset, half from the whole sphere, where a fiber's lobes
// may be.
void draw_directions(const std::vector<renderer::CurveLobes<double>>& lobes, const Sampling& sampling,
                     std::uint64_t number, View& view) {
  renderer::Sampler sampler(sampling.seed, number);
  for (int k = 0; k < sampling.directions; ++k) {
    sampler.start_sample(static_cast<std::uint32_t>(k));
    const Eigen::Vector2d u = sampler.next_2d().cast<double>(), v = sampler.next_2d().cast<double>(),
                          w = sampler.next_2d().cast<double>();
    if (u.x() < 0.5) {
      const auto h = static_cast<std::size_t>(2 * u.x() * static_cast<double>(lobes.size()));
      view.wi.push_back(lobes[h].sample(u.y(), v.x(), v.y(), w.x()));
    } else {
      const double z = 2 * v.x() - 1, radial = std::sqrt(1 - z * z), phi = 2 * std::numbers::pi * v.y();
      view.wi.emplace_back(z, radial * std::cos(phi), radial * std::sin(phi));
    }
  }
}

View view_of(const ThreadModel<double>& thread, const Matrix3d& colours, const std::vector<double>& offsets,
             double sin_theta, const Sampling& sampling, std::uint64_t number) {
  const double cos_theta = std::sqrt(1 - sin_theta * sin_theta);
  View view{.wo = {sin_theta, cos_theta, 0}, .weight = cos_theta};
  std::vector<renderer::CurveLobes<double>> lobes;
  for (double h : offsets) {
    lobes.push_back(thread.lobes_at(h, view.wo));
    view.albedo.emplace_back(colours * lobes.back().attenuation.colwise().sum().matrix().transpose());
  }
  draw_directions(lobes, sampling, number, view);
  for (const Direction& wi : view.wi) {
    double density = 0;
    std::vector<Array3d>& values = view.f_cos.emplace_back();
    for (const auto& at : lobes) {
      const renderer::ScatteringValue<double> value = at.evaluate(wi);
      values.emplace_back(colours * value.f_cos.matrix());
      density += value.pdf / static_cast<double>(offsets.size());
    }
    view.solid_angle.push_back(1 / ((0.5 * density + 0.5 / (4 * std::numbers::pi)) * sampling.directions));
  }
  return view;
}

Samples sample(const ThreadParameters& parameters, const Matrix3d& colours, const Sampling& sampling) {
  const ThreadModel<double> thread(parameters);
  Samples samples;
  for (int i = 0; i < sampling.offsets; ++i) samples.offsets.push_back(midpoint(i, sampling.offsets, -1, 1));
  double weights = 0;
  for (int i = 0; i < sampling.inclinations; ++i) {
    samples.views.push_back(view_of(thread, colours, samples.offsets, midpoint(i, sampling.inclinations, 0, 1),
                                    sampling, static_cast<std::uint64_t>(i)));
    weights += samples.views.back().weight;
  }
  const auto offsets = static_cast<double>(sampling.offsets);
  for (View& view : samples.views) {
    view.weight /= weights;
    for (std::size_t i = 0; i < view.wi.size(); ++i) {
      Array3d mean = Array3d::Zero();
      for (const Array3d& value : view.f_cos[i]) {
        samples.square += view.weight * view.solid_angle[i] * value.square().sum() / offsets;
        mean += value / offsets;
      }
      if (is_back(view.wi[i])) view.back += view.solid_angle[i] * mean;
      samples.square_far += view.weight * view.solid_angle[i] * mean.square().sum();
    }
    for (const Array3d& albedo : view.albedo) samples.albedo_square += view.weight * albedo.square().sum() / offsets;
  }
  return samples;
}

template <class S>
BasicFiberParameters<S> fiber_of(const S* u) {
  return {.eta = u[0], .sigma_a = {u[1], u[2], u[3]}, .beta_m = u[4], .beta_n = u[5]};
}

// Residuals whose squares sum to those of the three relative errors, weighted.
struct DifferenceTerm {
  const Samples& samples;

  template <class S>
  bool operator()(const S* u, S* residual) const {
    const FiberModel<S> fiber(fiber_of(u));
    const auto offsets = static_cast<double>(samples.offsets.size());
    for (const View& view : samples.views) {
      Eigen::Array<S, 3, 1> back = Eigen::Array<S, 3, 1>::Constant(S(0.0));
      for (std::size_t h = 0; h < samples.offsets.size(); ++h) {
        const auto lobes = fiber.lobes_at(samples.offsets[h], view.wo.cast<renderer::Geometry<S>>());
        const double albedo_scale = std::sqrt(kEnergyWeight * view.weight / (offsets * samples.albedo_square));
        for (int c = 0; c < 3; ++c)
          *residual++ = (S(lobes.attenuation.col(c).sum()) - S(view.albedo[h][c])) * S(albedo_scale);
        for (std::size_t i = 0; i < view.wi.size(); ++i) {
          const auto value = lobes.evaluate(view.wi[i]);
          const double scale = std::sqrt(view.weight * view.solid_angle[i] / (offsets * samples.square));
          for (int c = 0; c < 3; ++c) *residual++ = (value.f_cos[c] - S(view.f_cos[i][h][c])) * S(scale);
          if (is_back(view.wi[i])) back += value.f_cos * S(view.solid_angle[i] / offsets);
        }
      }
      const double back_scale = std::sqrt(kEnergyWeight * view.weight / samples.albedo_square);
      for (int c = 0; c < 3; ++c) *residual++ = (back[c] - S(view.back[c])) * S(back_scale);
    }
    return true;
  }
};

int residuals_of(const Samples& samples) {
  std::size_t count = 0;
  for (const View& view : samples.views) count += 3 + 3 * samples.offsets.size() * (1 + view.wi.size());
  return static_cast<int>(count);
}

struct Solution {
  std::array<double, kUnknowns> u{};
  double cost = std::numeric_limits<double>::infinity();
  bool converged = false;
};

Solution solve_from(const Samples& samples, const std::array<double, kUnknowns>& start) {
  Solution solution{.u = start};
  ceres::Problem problem;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<DifferenceTerm, ceres::DYNAMIC, kUnknowns>(
                               new DifferenceTerm{samples}, residuals_of(samples)),
                           nullptr, solution.u.data());
  const auto bound = [&](int unknown, double low, double high) {
    problem.SetParameterLowerBound(solution.u.data(), unknown, low);
    problem.SetParameterUpperBound(solution.u.data(), unknown, high);
  };
  bound(0, kLeastIndex, kMostFiberIndex);
  for (int c = 1; c <= 3; ++c) bound(c, 0, kMostAbsorption);
  for (int r = 4; r <= 5; ++r) bound(r, kLeastRoughness, 1);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;  // tens of thousands of rows, six columns
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-7;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  solution.cost = summary.final_cost;
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  return solution;
}

}  // namespace

FiberAgreement fiber_agreement(const FiberParameters& parameters, const ThreadParameters& thread,
                               const Matrix3d& colours) {
  const Samples samples = sample(thread, colours, kForTheReport);
  const FiberModel<double> fiber(parameters);
  const auto offsets = static_cast<double>(samples.offsets.size());
  FiberAgreement found;
  double square = 0, square_far = 0;
  for (const View& view : samples.views) {
    std::vector<Array3d> means(view.wi.size(), Array3d::Zero());
    for (std::size_t h = 0; h < samples.offsets.size(); ++h) {
      const auto lobes = fiber.lobes_at(samples.offsets[h], view.wo);
      found.thread_albedo += view.weight * view.albedo[h] / offsets;
      found.fiber_albedo += view.weight * lobes.attenuation.colwise().sum().transpose() / offsets;
      for (std::size_t i = 0; i < view.wi.size(); ++i) {
        const Array3d difference = lobes.evaluate(view.wi[i]).f_cos - view.f_cos[i][h];
        square += view.weight * view.solid_angle[i] * difference.square().sum() / offsets;
        means[i] += difference / offsets;
      }
    }
    found.thread_back += view.weight * view.back;
    found.fiber_back += view.weight * view.back;
    for (std::size_t i = 0; i < view.wi.size(); ++i) {
      if (is_back(view.wi[i])) found.fiber_back += view.weight * view.solid_angle[i] * means[i];
      square_far += view.weight * view.solid_angle[i] * means[i].square().sum();
    }
  }
  found.rms = std::sqrt(square / samples.square);
  found.rms_far = std::sqrt(square_far / samples.square_far);
  return found;
}

NearestFiber nearest_fiber(const ThreadParameters& thread, const Matrix3d& colours) {
  const Samples samples = sample(thread, colours, kForTheFit);
  if (!(samples.square > 0))
    throw std::runtime_error(
        "the thread scatters no light, which no fiber does; look at its lobes' energies r0, r1, r2");
  std::array<Solution, kStarts.size()> found;
  tbb::parallel_for(std::size_t{0}, kStarts.size(), [&](std::size_t i) { found[i] = solve_from(samples, kStarts[i]); });
  const Solution& best = *std::min_element(found.begin(), found.end(),
                                           [](const Solution& a, const Solution& b) { return a.cost < b.cost; });
  const FiberParameters fiber = fiber_of(best.u.data());
  return {fiber, fiber_agreement(fiber, thread, colours), best.converged};
}

}  // namespace inversion
