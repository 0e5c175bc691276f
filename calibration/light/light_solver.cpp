#include "calibration/light/light_solver.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibration {

using Eigen::Vector2d, Eigen::Vector3d;

// What a spot's radiance is predicted with, beside the unknowns.
struct SpotModel {
  PanelSpot spot;
  BeamFrame frame;
  Vector3d seed_intensity;
  double albedo, r2;
  double bounce;  // by table_bounce

  // The panel's radiance under the lamp alone, for unit intensity and without vignetting.
  template <typename T>
  T unit(const T* position, const T* beam, const T& mu, const T* droop) const {
    return unit_radiance<T>(spot, position, frame.direction(beam), mu, droop, albedo);
  }
  double table_unit() const { return albedo / std::numbers::pi * bounce; }
};

namespace {

// (predicted - measured) / sigma of a spot, RGB. Parameters: position, beam, lamp, droop, table, vignetting, log
// output. Automatic derivatives are taken of the panel's factor only; the others multiply it.
class SpotCost final : public ceres::SizedCostFunction<3, 3, 2, 4, 2, 1, 2, 1> {
 public:
  explicit SpotCost(SpotModel model) : model_(std::move(model)) {}

  bool Evaluate(const double* const* x, double* residuals, double** jacobians) const override {
    using UnitJet = ceres::Jet<double, 8>;  // position 0-2, beam 3-4, mu 5, droop 6-7
    const double *lamp = x[2], table = x[4][0];
    UnitJet unit;
    if (jacobians == nullptr) {
      unit = UnitJet(model_.unit(x[0], x[1], lamp[3], x[3]));
    } else {
      const UnitJet position[]{{x[0][0], 0}, {x[0][1], 1}, {x[0][2], 2}}, beam[]{{x[1][0], 3}, {x[1][1], 4}};
      const UnitJet mu(lamp[3], 5), droop[]{{x[3][0], 6}, {x[3][1], 7}};
      unit = model_.unit(position, beam, mu, droop);
    }
    const ceres::Jet<double, 2> v[]{{x[5][0], 0}, {x[5][1], 1}};
    const ceres::Jet<double, 2> gain = vignetting_gain(model_.r2, v);
    const double shape = unit.a + table * model_.table_unit(), output = std::exp(x[6][0]);
    for (int c = 0; c < 3; ++c) {
      const double over_sigma = output * std::exp(lamp[c]) * model_.seed_intensity[c] / model_.spot.sigma[c];
      const double predicted = over_sigma * gain.a * shape;
      residuals[c] = predicted - model_.spot.radiance[c] / model_.spot.sigma[c];
      if (jacobians == nullptr) continue;
      const Eigen::Matrix<double, 8, 1> by_unit = over_sigma * gain.a * unit.v;
      const auto row = [&](int block, int size) {
        return jacobians[block] == nullptr ? nullptr : jacobians[block] + c * size;
      };
      if (double* out = row(0, 3)) Eigen::Map<Vector3d>{out} = by_unit.head<3>();
      if (double* out = row(1, 2)) Eigen::Map<Vector2d>{out} = by_unit.segment<2>(3);
      if (double* out = row(2, 4)) {
        Eigen::Map<Eigen::Vector4d>{out} = Eigen::Vector4d(0, 0, 0, by_unit[5]);
        out[c] = predicted;
      }
      if (double* out = row(3, 2)) Eigen::Map<Vector2d>{out} = by_unit.tail<2>();
      if (double* out = row(4, 1)) *out = over_sigma * gain.a * model_.table_unit();
      if (double* out = row(5, 2)) Eigen::Map<Vector2d>{out} = over_sigma * shape * gain.v;
      if (double* out = row(6, 1)) *out = predicted;
    }
    return true;
  }

 private:
  SpotModel model_;
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

SpotModel LightSolver::model_of(std::size_t spot) const {
  const PanelSpot& seen = spots_[spot];
  return {seen,
          frame(static_cast<std::size_t>(seen.light)),
          seed_,
          options_.albedo,
          radius_squared(seen.pixel, options_.image_size),
          bounces_[spot]};
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
  // Outputs are eliminated first: each belongs to the spots of one picture.
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  std::vector<double*> blocks;
  problem.GetParameterBlocks(&blocks);
  for (double* block : blocks) {
    const bool output = block >= x.log_outputs.data() && block < x.log_outputs.data() + x.log_outputs.size();
    options.linear_solver_ordering->AddElementToGroup(block, output ? 0 : 1);
  }
  if (without >= 0) options.initial_trust_region_radius = 1e12;  // begins next to its end: Gauss-Newton
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
    const SpotModel model = model_of(number);
    const double unit = model.unit(x.positions[light].data(), x.beams[light].data(), x.lamp[3], x.droop.data());
    const double scale = std::exp(x.log_outputs[static_cast<std::size_t>(picture)]) *
                         vignetting_gain(model.r2, x.vignetting.data()) * (unit + x.table * model.table_unit());
    const Vector3d radiance = scale * x.lamp.head<3>().array().exp() * seed_.array();
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
    problem.AddResidualBlock(new SpotCost(model_of(number)), new ceres::HuberLoss(4.0), x.positions[light].data(),
                             x.beams[light].data(), x.lamp.data(), x.droop.data(), &x.table, x.vignetting.data(),
                             &x.log_outputs[picture]);
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
