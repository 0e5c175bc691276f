#include "station/bench/calibrate/error_budget.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "station/documents/degree.h"

namespace station {
namespace {

constexpr double kAlbedoSigma = 0.005;  // of a 99 % panel, by its certificate
constexpr double kTurned_rad = 45.0 * kDegree;
constexpr double kHolderSigma_rad = 0.02 * kDegree;  // of its pose: 60 simulated mountings

// Standard deviation of the lamp's direction as the spool sees it, rad: the worst across the line to it.
double direction_sigma(const calibration::LightFit& light, std::size_t place) {
  const Eigen::Vector3d position = light.positions.at(place);
  const double distance_mm = position.norm();
  const Eigen::Vector3d to_light = position / distance_mm;
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - to_light * to_light.transpose();
  const Eigen::Matrix3d covariance = across * light.position_covariances.at(place) * across;
  const double largest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff();
  return std::sqrt(std::max(0.0, largest)) / distance_mm;
}

double shutter_sigma(const calibration::SensorResponse& response) {
  double worst = 0.0;
  for (const calibration::ShutterTime& time : response.shutter) worst = std::max(worst, time.sigma_s / time.true_s);
  return worst;
}

void add_sensor(const SensorSection& sensor, std::vector<ErrorShare>& shares) {
  // A view's exposure and the panel's differ: one error each.
  shares.push_back({"shutter times", std::sqrt(2.0) * shutter_sigma(sensor.response)});
  shares.push_back(
      {"linearity of the sensor", std::max(sensor.linearity_residual, sensor.response.nonlinearity_sigma)});
  shares.push_back({"flicker of the lamp", sensor.lamp_flicker});
}

}  // namespace

std::vector<ErrorShare> error_budget(const RigCalibration& calibration, bool behind) {
  const calibration::LightFit& light = calibration.light;
  const std::size_t place = behind ? 1 : 0;
  const double axis_sigma_rad = std::sqrt(calibration.platform.axis_covariance.topLeftCorner<2, 2>().trace());
  std::vector<ErrorShare> shares{
      {"lamp: intensity, distance and beam at the platform", light.aim_irradiance_sigma.at(place)},
      {"lamp: direction", std::tan(kTurned_rad) * direction_sigma(light, place)},
      {"Spectralon: albedo by its certificate", kAlbedoSigma},
      {"platform and holder: angle to the lamp", std::tan(kTurned_rad) * std::hypot(axis_sigma_rad, kHolderSigma_rad)}};
  if (calibration.sensor) add_sensor(*calibration.sensor, shares);
  double squares = 0.0;
  for (const ErrorShare& share : shares) squares += share.relative * share.relative;
  shares.push_back({"all", std::sqrt(squares)});
  return shares;
}

std::string describe_budget(const RigCalibration& calibration) {
  const std::vector<ErrorShare> front = error_budget(calibration, false), back = error_budget(calibration, true);
  std::string text = "error of a radiance at the spool, lamp in front / behind (1 sigma, %)\n";
  for (std::size_t i = 0; i < front.size(); ++i) {
    char line[160];
    std::snprintf(line, sizeof line, "  %-52s %6.3f  %6.3f\n", front[i].source.c_str(), 100 * front[i].relative,
                  100 * back[i].relative);
    text += line;
  }
  return text;
}

}  // namespace station
