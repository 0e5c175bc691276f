#include "calibration/light.h"

#include <ceres/ceres.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace calibration {
namespace {

constexpr std::size_t kFewestPatches = 6;

[[noreturn]] void refuse(const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("light calibration: " + found + ": " + what_to_do);
}

// Square of the distance to the image centre, in half diagonals.
double radius_squared(double column, double row, cv::Size size) {
  const double dx = column - 0.5 * (size.width - 1), dy = row - 0.5 * (size.height - 1);
  const double width = size.width, height = size.height;
  return 4.0 * (dx * dx + dy * dy) / (width * width + height * height);
}

template <typename T>
T gain_at(double r2, const T& v0, const T& v1) {
  return T(1) + r2 * (v0 + r2 * v1);
}

// cos(theta) / d^2 at a patch.
template <typename T>
T falloff(const T* position, const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  const Eigen::Matrix<T, 3, 1> to_light(position[0] - point.x(), position[1] - point.y(), position[2] - point.z());
  const T d2 = to_light.squaredNorm();
  return to_light.dot(normal.cast<T>()) / (d2 * sqrt(d2));
}

// Intensities are of the order of 1e6 beside positions of 1e2 and vignetting of 1e-1; the fit sees them as factors of
// their first guess, or the covariance would look singular.
struct PatchResidual {
  LightPatch patch;
  double albedo;
  double r2;
  Eigen::Vector3d seed_intensity;

  template <typename T>
  bool operator()(const T* position, const T* factor, const T* vignetting, T* residual) const {
    const T irradiance = falloff(position, patch.point, patch.normal);
    const T scale = gain_at(r2, vignetting[0], vignetting[1]) * (albedo / M_PI) * irradiance;
    for (int c = 0; c < 3; ++c)
      residual[c] = (scale * (factor[c] * seed_intensity[c]) - patch.radiance[c]) / patch.sigma[c];
    return true;
  }
};

// Lenses darken by up to about half towards the corners. Without the prior a panel that stays in the picture's middle
// would leave the second term undetermined.
struct VignettingPrior {
  template <typename T>
  bool operator()(const T* vignetting, T* residual) const {
    constexpr double kSigma = 0.5;
    residual[0] = vignetting[0] / kSigma;
    residual[1] = vignetting[1] / kSigma;
    return true;
  }
};

void check(const std::vector<LightPatch>& patches, const std::vector<Eigen::Vector3d>& guesses, double albedo,
           cv::Size size) {
  if (guesses.empty()) refuse("no guess of a light's position was given", "measure it with a tape");
  if (!(albedo > 0.0 && albedo <= 1.0))
    refuse("the panel's albedo is " + std::to_string(albedo), "give a number above 0 and up to 1");
  if (size.width < 2 || size.height < 2) refuse("the size of the pictures is missing", "give it");
  for (const LightPatch& patch : patches) {
    if (patch.light < 0 || patch.light >= static_cast<int>(guesses.size())) {
      refuse("a patch belongs to light " + std::to_string(patch.light) + ", positions of " +
                 std::to_string(guesses.size()) + " lights were given",
             "give one guess per light");
    }
    const bool finite = patch.point.allFinite() && patch.normal.allFinite() && patch.pixel.allFinite() &&
                        patch.radiance.allFinite() && patch.sigma.allFinite();
    if (!finite || !(patch.sigma.minCoeff() > 0.0)) {
      refuse("a patch has a measurement that is not a finite number, or no standard error", "leave this picture out");
    }
  }
  for (const Eigen::Vector3d& guess : guesses) {
    if (!guess.allFinite()) refuse("a guessed position is not a finite number", "measure it with a tape");
  }
}

// The patches that face their light. Grazing ones say more about the panel's edge and surface than about the light.
std::vector<LightPatch> usable(const std::vector<LightPatch>& patches, const std::vector<Eigen::Vector3d>& guesses) {
  const double kSmallestCosine = std::sin(5.0 * M_PI / 180.0);
  std::vector<LightPatch> out;
  for (LightPatch patch : patches) {
    patch.normal.normalize();
    const Eigen::Vector3d to_light = (guesses[static_cast<std::size_t>(patch.light)] - patch.point).normalized();
    const bool bright = (patch.radiance.array() > 3.0 * patch.sigma.array()).all();
    if (bright && to_light.dot(patch.normal) > kSmallestCosine) out.push_back(patch);
  }
  return out;
}

// One direction of the panel alone leaves the distance of the light to its intensity.
void require_enough(const std::vector<LightPatch>& used, std::size_t lights) {
  constexpr double kSameDirection = 0.99619;  // cosine of 5 degrees
  for (std::size_t light = 0; light < lights; ++light) {
    std::size_t count = 0;
    bool turned = false;
    const LightPatch* first = nullptr;
    for (const LightPatch& patch : used) {
      if (patch.light != static_cast<int>(light)) continue;
      if (first == nullptr) first = &patch;
      turned = turned || patch.normal.dot(first->normal) < kSameDirection;
      ++count;
    }
    const std::string name = "light " + std::to_string(light);
    if (count < kFewestPatches) {
      refuse(name + " lights " + std::to_string(count) + " patches of the panel, at least " +
                 std::to_string(kFewestPatches) + " are needed",
             "turn the panel's face to the lamp and to the camera, and check the lamp's measured position");
    }
    if (!turned)
      refuse(name + " was seen on the panel in one direction only",
             "take pictures with the panel turned by 20 to 40 degrees");
  }
}

// Least squares of the intensity with everything else as guessed.
Eigen::Vector3d seed_intensity(const std::vector<LightPatch>& used, const std::vector<Eigen::Vector3d>& guesses,
                               double albedo) {
  Eigen::Array3d cross = Eigen::Array3d::Zero(), square = cross;
  for (const LightPatch& patch : used) {
    const double model =
        albedo / M_PI * falloff(guesses[static_cast<std::size_t>(patch.light)].data(), patch.point, patch.normal);
    const Eigen::Array3d weight = patch.sigma.array().square().inverse();
    cross += weight * model * patch.radiance.array();
    square += weight * model * model;
  }
  return cross / square;
}

struct Unknowns {
  std::vector<Eigen::Vector3d> positions;
  Eigen::Vector3d factor = Eigen::Vector3d::Ones();  // of the intensity's first guess
  std::array<double, 2> vignetting{};
};

void take_covariances(ceres::Problem& problem, const Unknowns& unknowns, const Eigen::Vector3d& seed, double variance,
                      LightFit& fit) {
  std::vector<const double*> blocks{unknowns.factor.data(), unknowns.vignetting.data()};
  for (const Eigen::Vector3d& position : unknowns.positions) blocks.push_back(position.data());
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  fit.position_covariances.assign(unknowns.positions.size(),
                                  Eigen::Matrix3d::Constant(std::numeric_limits<double>::infinity()));
  fit.intensity_covariance.setConstant(std::numeric_limits<double>::infinity());
  if (!covariance.Compute(blocks, &problem)) {
    fit.converged = false;
    return;
  }
  const auto block3 = [&](const double* block) {
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> out;
    covariance.GetCovarianceBlock(block, block, out.data());
    return Eigen::Matrix3d(variance * out);
  };
  for (std::size_t i = 0; i < unknowns.positions.size(); ++i)
    fit.position_covariances[i] = block3(unknowns.positions[i].data());
  fit.intensity_covariance = seed.asDiagonal() * block3(unknowns.factor.data()) * seed.asDiagonal();
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> vignetting;
  covariance.GetCovarianceBlock(blocks[1], blocks[1], vignetting.data());
  fit.vignetting_covariance = variance * vignetting;
}

}  // namespace

double Vignetting::gain(double column, double row, cv::Size image_size) const {
  return gain_at(radius_squared(column, row, image_size), v0, v1);
}

LightFit fit_light(const std::vector<LightPatch>& patches, const std::vector<Eigen::Vector3d>& guesses, double albedo,
                   cv::Size image_size) {
  check(patches, guesses, albedo, image_size);
  const std::vector<LightPatch> used = usable(patches, guesses);
  require_enough(used, guesses.size());

  const Eigen::Vector3d seed = seed_intensity(used, guesses, albedo);
  Unknowns unknowns{.positions = guesses};
  ceres::Problem problem;
  std::vector<PatchResidual*> residuals;  // owned by the problem
  for (const LightPatch& patch : used) {
    residuals.push_back(
        new PatchResidual{patch, albedo, radius_squared(patch.pixel.x(), patch.pixel.y(), image_size), seed});
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PatchResidual, 3, 3, 3, 2>(residuals.back()),
                             new ceres::HuberLoss(4.0),
                             unknowns.positions[static_cast<std::size_t>(patch.light)].data(), unknowns.factor.data(),
                             unknowns.vignetting.data());
  }
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<VignettingPrior, 2, 2>(new VignettingPrior), nullptr,
                           unknowns.vignetting.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  LightFit fit;
  fit.converged = summary.termination_type == ceres::CONVERGENCE && unknowns.factor.minCoeff() > 0.0;
  fit.positions = unknowns.positions;
  fit.intensity = unknowns.factor.cwiseProduct(seed);
  fit.vignetting = {.v0 = unknowns.vignetting[0], .v1 = unknowns.vignetting[1]};
  fit.patches_used = static_cast<int>(used.size());
  double weighted = 0.0, relative = 0.0;
  for (const PatchResidual* residual : residuals) {
    Eigen::Vector3d r;
    (*residual)(unknowns.positions[static_cast<std::size_t>(residual->patch.light)].data(), unknowns.factor.data(),
                unknowns.vignetting.data(), r.data());
    weighted += r.squaredNorm();
    relative += (r.array() * residual->patch.sigma.array() / residual->patch.radiance.array()).square().sum();
  }
  const double count = 3.0 * static_cast<double>(used.size());
  const double parameters = 3.0 * static_cast<double>(guesses.size()) + 5.0;
  fit.relative_rms = std::sqrt(relative / count);
  // Scatter beyond the given standard errors widens the covariance; less than them does not narrow it.
  take_covariances(problem, unknowns, seed, std::max(1.0, weighted / (count - parameters)), fit);
  return fit;
}

}  // namespace calibration
