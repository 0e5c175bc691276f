// The least squares solver of the light calibration (light.h), which fits all pictures of the panel or all but one.
#pragma once

#include <optional>
#include <vector>

#include "calibration/light/light_model.h"

namespace ceres {
class Problem;
}

namespace calibration {

// The unknowns of the fit. Intensities are of the order of 1e6, positions of 1e2, droops of 1e-1; therefore intensities
// are logarithms of factors on their first guess.
struct Unknowns {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector2d> beams;
  Eigen::Vector4d lamp = {0, 0, 0, 1};  // log(intensity / seed) (RGB), mu
  Eigen::Vector2d droop{0.08, 0.0};     // of the published shape, of incidence alone
  double table = 0.03;                  // the table's albedo
  Eigen::Vector2d vignetting = Eigen::Vector2d::Zero();
  std::vector<double> log_outputs;  // one per picture
};

struct SpotModel;

// The arguments of the constructor must outlive the solver.
class LightSolver {
 public:
  LightSolver(const std::vector<PanelSpot>& spots, const std::vector<LightGuess>& guesses, const LightOptions& options,
              const std::vector<LightPicture>& pictures);

  Unknowns first_guess() const;
  // Starts from `x` and improves it; false when it did not converge. `without`: index of a picture to leave out, or -1.
  bool solve(Unknowns& x, int without = -1) const;
  // The covariance of a light's position (mm^2) for the scatter of spots and the drift and tilts that are expected;
  // none when the position is undetermined.
  std::optional<Eigen::Matrix3d> position_covariance(Unknowns x, std::size_t light) const;
  // Predicted / measured radiance - 1 of each spot of a picture, per channel.
  std::vector<Eigen::Vector3d> relative_errors(const Unknowns& x, int picture) const;

  const std::vector<PanelSpot>& spots() const { return spots_; }
  const Eigen::Vector3d& seed() const { return seed_; }  // first guess of the intensity (RGB)
  BeamFrame frame(std::size_t light) const { return BeamFrame(guesses_[light]); }

 private:
  SpotModel model_of(std::size_t spot) const;
  void pose_problem(ceres::Problem& problem, Unknowns& x, int without) const;
  void add_priors(ceres::Problem& problem, Unknowns& x, const std::vector<double>& steepness) const;
  Eigen::Vector3d seed_intensity() const;

  const std::vector<PanelSpot>& spots_;
  const std::vector<LightGuess>& guesses_;
  const LightOptions& options_;
  const std::vector<LightPicture>& pictures_;
  std::vector<double> bounces_;  // one per spot
  Eigen::Vector3d seed_;
};

}  // namespace calibration
