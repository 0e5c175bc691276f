#include "renderer/scattering/density_fit.h"

#include <ceres/ceres.h>
#include <tbb/parallel_for.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kWeak = 0.1;        // standard deviation beyond which a direction is called weak
constexpr double kAtBound = 1e-6;    // of the distance between the bounds
constexpr double kLeastPart = 0.15;  // components of weak directions below this are left out

// The number of bins of all distributions together, which stand one below the other in the vector of residuals.
Eigen::Index bins_of(const std::vector<AzimuthalData>& data) {
  Eigen::Index bins = 0;
  for (const AzimuthalData& d : data) bins += d.density.size();
  return bins;
}

void evaluate_all(const std::vector<AzimuthalData>& data, const DensityModel& model, const VectorXd& u,
                  VectorXd& densities, MatrixXd* jacobian) {
  densities.resize(bins_of(data));
  if (jacobian) jacobian->setZero(densities.size(), u.size());
  std::vector<Eigen::Index> first(data.size(), 0);
  for (std::size_t k = 1; k < data.size(); ++k) first[k] = first[k - 1] + data[k - 1].density.size();
  tbb::parallel_for(std::size_t{0}, data.size(), [&](std::size_t k) {
    const Eigen::Index bins = data[k].density.size();
    ArrayXd density = ArrayXd::Zero(bins);
    MatrixXd slopes = jacobian ? MatrixXd::Zero(bins, u.size()) : MatrixXd();
    model.evaluate(k, u, density, jacobian ? &slopes : nullptr);
    densities.segment(first[k], bins) = density;
    if (jacobian) jacobian->middleRows(first[k], bins) = slopes;
  });
}

class DensityTerm : public ceres::CostFunction {
 public:
  DensityTerm(const std::vector<AzimuthalData>& data, const DensityModel& model) : data_(data), model_(model) {
    set_num_residuals(static_cast<int>(bins_of(data)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(model.unknowns.size()));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const auto count = static_cast<Eigen::Index>(model_.unknowns.size());
    VectorXd densities;
    MatrixXd jacobian;
    evaluate_all(data_, model_, Eigen::Map<const VectorXd>(parameters[0], count), densities,
                 jacobians && jacobians[0] ? &jacobian : nullptr);
    double* residual = residuals;
    Eigen::Index row = 0;
    for (const AzimuthalData& d : data_)
      for (double measured : d.density) *residual++ = densities[row++] - measured;
    if (jacobian.size() > 0)
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], row, count) =
          jacobian;
    return true;
  }

 private:
  const std::vector<AzimuthalData>& data_;
  const DensityModel& model_;
};

struct Solution {
  VectorXd u;
  double cost = std::numeric_limits<double>::infinity();
  bool converged = false;
};

Solution solve_from(const std::vector<AzimuthalData>& data, const DensityModel& model, const VectorXd& start) {
  Solution solution{.u = start};
  ceres::Problem problem;
  problem.AddResidualBlock(new DensityTerm(data, model), nullptr, solution.u.data());
  for (std::size_t i = 0; i < model.unknowns.size(); ++i) {
    const FitUnknown& unknown = model.unknowns[i];
    const auto k = static_cast<Eigen::Index>(i);
    solution.u[k] = std::clamp(solution.u[k], unknown.low, unknown.high);
    problem.SetParameterLowerBound(solution.u.data(), static_cast<int>(i), unknown.low);
    problem.SetParameterUpperBound(solution.u.data(), static_cast<int>(i), unknown.high);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  solution.cost = summary.final_cost;
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  return solution;
}

bool at_bound(const FitUnknown& unknown, double value) {
  const double near = kAtBound * (unknown.high - unknown.low);
  return value <= unknown.low + near || value >= unknown.high - near;
}

std::vector<Eigen::Index> free_values(const AzimuthalFit& fit) {
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < fit.values.size(); ++i)
    if (!fit.values[i].at_bound) free.push_back(static_cast<Eigen::Index>(i));
  return free;
}

// Standard deviations and weak directions of the unknowns that are not at a bound, from the singular values of the
// Jacobian and the variance of the residuals. Residuals are mostly the model's own error, so that this says what the
// data determine, not how the data's noise would scatter.
void judge(const DensityModel& model, const Solution& solution, const MatrixXd& jacobian, AzimuthalFit& fit) {
  for (std::size_t i = 0; i < model.unknowns.size(); ++i) {
    const double value = solution.u[static_cast<Eigen::Index>(i)];
    fit.values.push_back({model.unknowns[i].name, value, 0, at_bound(model.unknowns[i], value)});
  }
  const std::vector<Eigen::Index> free = free_values(fit);
  if (free.empty()) return;
  const Eigen::JacobiSVD<MatrixXd> svd(jacobian(Eigen::all, free), Eigen::ComputeThinV);
  const auto freedom = std::max<Eigen::Index>(1, jacobian.rows() - static_cast<Eigen::Index>(free.size()));
  const double residual_deviation = std::sqrt(2 * solution.cost / static_cast<double>(freedom));
  const VectorXd singular = svd.singularValues();
  VectorXd variance = VectorXd::Zero(static_cast<Eigen::Index>(free.size()));
  for (Eigen::Index i = 0; i < singular.size(); ++i) {
    const double deviation = residual_deviation / std::max(singular[i], std::numeric_limits<double>::min());
    const VectorXd direction = svd.matrixV().col(i);
    variance += deviation * deviation * direction.cwiseAbs2();
    if (deviation < kWeak) continue;
    WeakDirection weak{deviation, {}};
    for (Eigen::Index k = 0; k < direction.size(); ++k)
      if (std::abs(direction[k]) > kLeastPart)
        weak.parts.emplace_back(model.unknowns[static_cast<std::size_t>(free[static_cast<std::size_t>(k)])].name,
                                direction[k]);
    fit.weak.push_back(weak);
  }
  for (std::size_t k = 0; k < free.size(); ++k)
    fit.values[static_cast<std::size_t>(free[k])].deviation = std::sqrt(variance[static_cast<Eigen::Index>(k)]);
}

// AzimuthalFit::covariance. That an unknown lies somewhere between its bounds is one more piece of information on it,
// for directions that the distributions left in do not tell.
MatrixXd jackknife(const std::vector<AzimuthalData>& data, const DensityModel& model, const VectorXd& densities,
                   const MatrixXd& jacobian, const AzimuthalFit& fit) {
  MatrixXd covariance = MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  const std::vector<Eigen::Index> free = free_values(fit);
  if (free.empty() || data.size() < 2) return covariance;
  const MatrixXd by_free = jacobian(Eigen::all, free);
  std::vector<Eigen::Index> first{0};
  VectorXd residuals = densities;
  for (const AzimuthalData& d : data) {
    residuals.segment(first.back(), d.density.size()) -= d.density.matrix();
    first.push_back(first.back() + d.density.size());
  }
  const double variance = residuals.squaredNorm() / static_cast<double>(residuals.size());
  VectorXd bounds(by_free.cols());
  for (std::size_t k = 0; k < free.size(); ++k) {
    const FitUnknown& unknown = model.unknowns[static_cast<std::size_t>(free[k])];
    bounds[static_cast<Eigen::Index>(k)] = 12 * variance / std::pow(unknown.high - unknown.low, 2);
  }
  MatrixXd hessian = by_free.transpose() * by_free, squares = MatrixXd::Zero(by_free.cols(), by_free.cols());
  hessian.diagonal() += bounds;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const MatrixXd left_out = by_free.middleRows(first[k], first[k + 1] - first[k]);
    const VectorXd gradient = left_out.transpose() * residuals.segment(first[k], left_out.rows());
    const VectorXd moved = (hessian - left_out.transpose() * left_out).ldlt().solve(gradient);
    squares += moved * moved.transpose();
  }
  const auto count = static_cast<double>(data.size());
  covariance(free, free) = squares * (count - 1) / count;
  return covariance;
}

}  // namespace

double relative_error(const std::vector<AzimuthalData>& data, const std::vector<ArrayXd>& fit) {
  double difference = 0, whole = 0;
  for (std::size_t k = 0; k < data.size(); ++k) {
    difference += (fit[k] - data[k].density).square().sum();
    whole += data[k].density.square().sum();
  }
  return std::sqrt(difference / whole);
}

VectorXd fit_densities(const std::vector<AzimuthalData>& data, const DensityModel& model,
                       const std::vector<VectorXd>& starts, AzimuthalFit& fit) {
  Solution best;
  for (const VectorXd& start : starts) {
    const Solution found = solve_from(data, model, start);
    if (found.cost < best.cost) best = found;
  }
  VectorXd densities;
  MatrixXd jacobian;
  evaluate_all(data, model, best.u, densities, &jacobian);
  fit.converged = best.converged;
  judge(model, best, jacobian, fit);
  fit.covariance = jackknife(data, model, densities, jacobian, fit);
  Eigen::Index row = 0;
  for (const AzimuthalData& d : data) {
    fit.densities.emplace_back(densities.segment(row, d.density.size()));
    row += d.density.size();
    fit.errors.push_back(relative_error({d}, {fit.densities.back()}));
  }
  fit.error = relative_error(data, fit.densities);
  return best.u;
}

}  // namespace renderer
