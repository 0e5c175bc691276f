#include "calibration/light/light_solver.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibration {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

struct SpotResidual {
  PanelSpot spot;
  BeamFrame frame;
  Vector3d seed_intensity;
  double albedo, r2;
  double bounce;  // by table_bounce

  template <typename T>
  void predict(const T* position, const T* beam, const T* lamp, const T* droop, const T* table, const T* vignetting,
               const T* log_output, T* radiance) const {
    using std::exp;
    const T unit = unit_radiance<T>(spot, position, frame.direction(beam), lamp[3], droop, albedo);
    const T scale =
        exp(*log_output) * vignetting_gain(r2, vignetting) * (unit + *table * (albedo / std::numbers::pi * bounce));
    for (int c = 0; c < 3; ++c) radiance[c] = scale * exp(lamp[c]) * seed_intensity[c];
  }

  template <typename T>
  bool operator()(const T* position, const T* beam, const T* lamp, const T* droop, const T* table, const T* vignetting,
                  const T* log_output, T* residual) const {
    predict(position, beam, lamp, droop, table, vignetting, log_output, residual);
    for (int c = 0; c < 3; ++c) residual[c] = (residual[c] - spot.radiance[c]) / spot.sigma[c];
    return true;
  }
};

// The residuals of a normal prior on N numbers.
template <int N>
struct Prior {
  Eigen::Matrix<double, N, 1> mean, sigma;

  template <typename T>
  bool operator()(const T* x, T* residual) const {
    for (int i = 0; i < N; ++i) residual[i] = (x[i] - mean[i]) / sigma[i];
    return true;
  }
};

template <int N>
void add_prior(ceres::Problem& problem, double* x, const Eigen::Matrix<double, N, 1>& mean,
               const Eigen::Matrix<double, N, 1>& sigma, ceres::LossFunction* loss = nullptr) {
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior<N>, N, N>(new Prior<N>{mean, sigma}), loss, x);
}

}  // namespace

LightSolver::LightSolver(const std::vector<PanelSpot>& spots, const std::vector<LightGuess>& guesses,
                         const LightOptions& options, const std::vector<LightPicture>& pictures)
    : spots_(spots), guesses_(guesses), options_(options), pictures_(pictures), seed_(seed_intensity()) {
  for (const PanelSpot& spot : spots_)
    bounces_.push_back(table_bounce(spot, guesses_[static_cast<std::size_t>(spot.light)], options_.table_mm));
}

Unknowns LightSolver::first_guess() const {
  Unknowns start;
  for (const LightGuess& guess : guesses_) {
    start.positions.push_back(guess.position);
    start.beams.push_back(Vector2d::Zero());
  }
  for (const LightPicture& picture : pictures_)
    start.log_outputs.push_back(picture.output ? std::log(*picture.output) : 0.0);
  return start;
}

bool LightSolver::solve(Unknowns& x, int without) const {
  ceres::Problem problem;
  pose_problem(problem, x, without);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.termination_type == ceres::CONVERGENCE;
}

std::optional<Eigen::Matrix3d> LightSolver::position_covariance(Unknowns x, std::size_t light) const {
  ceres::Problem problem;
  pose_problem(problem, x, -1);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  const double* block = x.positions[light].data();
  if (!covariance.Compute(std::vector<const double*>{block}, &problem)) return std::nullopt;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> out;
  covariance.GetCovarianceBlock(block, block, out.data());
  return Eigen::Matrix3d(out);
}

std::vector<Vector3d> LightSolver::relative_errors(const Unknowns& x, int picture) const {
  std::vector<Vector3d> errors;
  for (std::size_t number = 0; number < spots_.size(); ++number) {
    const PanelSpot& spot = spots_[number];
    if (spot.picture != picture) continue;
    const auto light = static_cast<std::size_t>(spot.light);
    Vector3d radiance;
    const SpotResidual residual{spot,
                                frame(static_cast<std::size_t>(spot.light)),
                                seed_,
                                options_.albedo,
                                radius_squared(spot.pixel, options_.image_size),
                                bounces_[number]};
    residual.predict(x.positions[light].data(), x.beams[light].data(), x.lamp.data(), x.droop.data(), &x.table,
                     x.vignetting.data(), &x.log_outputs[static_cast<std::size_t>(picture)], radiance.data());
    errors.push_back((radiance.array() / spot.radiance.array() - 1.0).matrix());
  }
  return errors;
}

void LightSolver::pose_problem(ceres::Problem& problem, Unknowns& x, int without) const {
  std::vector<double> steepness(pictures_.size(), 0.0);  // tangent of incidence: relative change per radian of tilt
  for (std::size_t number = 0; number < spots_.size(); ++number) {
    const PanelSpot& spot = spots_[number];
    if (spot.picture == without) continue;
    const auto light = static_cast<std::size_t>(spot.light), picture = static_cast<std::size_t>(spot.picture);
    const double cosine = (guesses_[light].position - spot.point).normalized().dot(spot.normal);
    steepness[picture] = std::max(steepness[picture], std::sqrt(1.0 - cosine * cosine) / std::max(cosine, 0.05));
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SpotResidual, 3, 3, 2, 4, 2, 1, 2, 1>(new SpotResidual{
                                 spot, frame(static_cast<std::size_t>(spot.light)), seed_, options_.albedo,
                                 radius_squared(spot.pixel, options_.image_size), bounces_[number]}),
                             new ceres::HuberLoss(4.0), x.positions[light].data(), x.beams[light].data(), x.lamp.data(),
                             x.droop.data(), &x.table, x.vignetting.data(), &x.log_outputs[picture]);
  }
  add_priors(problem, x, steepness);
}

void LightSolver::add_priors(ceres::Problem& problem, Unknowns& x, const std::vector<double>& steepness) const {
  for (std::size_t i = 0; i < pictures_.size(); ++i) {
    if (!problem.HasParameterBlock(&x.log_outputs[i])) continue;
    const LightPicture& picture = pictures_[i];
    const double output = picture.output ? std::log(*picture.output) : 0.0;
    const double sigma =
        std::hypot(picture.output ? picture.output_sigma : options_.drift, options_.pose_sigma_rad * steepness[i]);
    add_prior<1>(problem, &x.log_outputs[i], Eigen::Matrix<double, 1, 1>(output), Eigen::Matrix<double, 1, 1>(sigma),
                 new ceres::HuberLoss(3.0));
  }
  for (std::size_t i = 0; i < guesses_.size(); ++i) {
    if (!problem.HasParameterBlock(x.positions[i].data())) continue;
    // The robust loss keeps a tape measure that was misread by decimetres from pulling the position.
    add_prior<3>(problem, x.positions[i].data(), guesses_[i].position,
                 Vector3d::Constant(guesses_[i].position_sigma_mm), new ceres::HuberLoss(3.0));
    add_prior<2>(problem, x.beams[i].data(), Vector2d::Zero(), Vector2d::Constant(guesses_[i].aim_sigma_rad));
  }
  // A flashlight without optics of its own has mu between 0 and 2; panels droop by 0 to 16 %.
  add_prior<4>(problem, x.lamp.data(), {0, 0, 0, 1}, {100, 100, 100, 1});
  add_prior<1>(problem, &x.table, Eigen::Matrix<double, 1, 1>(0.03), Eigen::Matrix<double, 1, 1>(0.03));
  add_prior<2>(problem, x.droop.data(), {0.08, 0.0}, {0.1, options_.published_droop_only ? 1e-6 : 0.05});
  // Lenses darken by up to about half towards the corners.
  add_prior<2>(problem, x.vignetting.data(), Vector2d::Zero(), Vector2d::Constant(0.5));
}

// The intensity by least squares, with everything else as guessed.
Vector3d LightSolver::seed_intensity() const {
  const Unknowns start = first_guess();
  Eigen::Array3d cross = Eigen::Array3d::Zero(), square = cross;
  for (const PanelSpot& spot : spots_) {
    const auto light = static_cast<std::size_t>(spot.light);
    const double unit = unit_radiance<double>(spot, start.positions[light].data(), frame(light).axis, start.lamp[3],
                                              start.droop.data(), options_.albedo);
    const Eigen::Array3d weight = spot.sigma.array().square().inverse();
    cross += weight * unit * spot.radiance.array();
    square += weight * unit * unit;
  }
  return cross / square;
}

}  // namespace calibration
