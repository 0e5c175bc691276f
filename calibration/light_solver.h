// The least squares behind the light calibration (light.h): fits to all pictures of the panel, or to all but one.
#pragma once

#include <optional>
#include <vector>

#include "calibration/light_model.h"

namespace ceres {
class Problem;
}

namespace calibration {

// Intensities are of the order of 1e6 beside positions of 1e2 and a droop of 1e-1; the fit sees logarithms of factors
// of their first guess.
struct Unknowns {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector2d> beams;
  Eigen::Vector4d lamp = {0, 0, 0, 1};  // log intensity over the seed (RGB), mu
  Eigen::Vector2d droop{0.08, 0.0};     // published shape, incidence alone
  double table = 0.03;                  // albedo
  Eigen::Vector2d vignetting = Eigen::Vector2d::Zero();
  std::vector<double> log_outputs;  // per picture
};

// What is given to it must outlive it.
class LightSolver {
 public:
  LightSolver(const std::vector<LightPatch>& patches, const std::vector<LightGuess>& guesses,
              const LightOptions& options, const std::vector<LightPicture>& pictures);

  Unknowns first_guess() const;
  // Starts from `x` and improves it; false when it did not converge. `without`: index of a picture to leave out, or -1.
  bool solve(Unknowns& x, int without = -1) const;
  // Of a position, for the scatter of patches and the drift and tilts that are expected; none when it has no bounds.
  std::optional<Eigen::Matrix3d> position_covariance(Unknowns x, std::size_t light) const;
  // Predicted over measured radiance of each patch of a picture, less 1, per channel.
  std::vector<Eigen::Vector3d> relative_errors(const Unknowns& x, int picture) const;

  const std::vector<LightPatch>& patches() const { return patches_; }
  const Eigen::Vector3d& seed() const { return seed_; }  // of the intensity
  BeamFrame frame(std::size_t light) const { return BeamFrame(guesses_[light]); }

 private:
  void pose_problem(ceres::Problem& problem, Unknowns& x, int without) const;
  void add_priors(ceres::Problem& problem, Unknowns& x, const std::vector<double>& steepness) const;
  Eigen::Vector3d seed_intensity() const;

  const std::vector<LightPatch>& patches_;
  const std::vector<LightGuess>& guesses_;
  const LightOptions& options_;
  const std::vector<LightPicture>& pictures_;
  std::vector<double> bounces_;  // one per patch
  Eigen::Vector3d seed_;
};

}  // namespace calibration
