#include "calibration/light/light.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "calibration/light/light_model.h"
#include "calibration/light/light_solver.h"
#include "calibration/sensor/degree.h"
#include "calibration/sensor/median.h"

namespace calibration {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr std::size_t kFewestSpots = 6;
constexpr std::size_t kFewestPictures = 6;
constexpr double kWeakest_mm = 8.0;      // largest standard error of a position, for the scatter and drift expected
constexpr double kHeldOutLimit = 0.005;  // mean error of a picture that the fit has not seen
constexpr double kResidualLimit = 0.01;  // rms of the spots of one picture
constexpr double kOutputLimit = 0.03;    // a lamp that changed by more is not warmed up or not the only light
constexpr double kTapeLimit_mm = 150.0;
constexpr double kDarkLimit = 0.3;  // part of the other pictures' brightness below which a picture is dark

std::string text(const char* format, double value) {
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

[[noreturn]] void refuse_light(const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("light calibration: " + found + ": " + what_to_do);
}

void check(const std::vector<PanelSpot>& spots, const std::vector<LightGuess>& guesses, const LightOptions& options,
           std::size_t pictures) {
  if (guesses.empty()) refuse_light("no guess of a light's position was given", "measure it with a tape");
  if (!(options.albedo > 0.0 && options.albedo <= 1.0))
    refuse_light("the panel's albedo is " + std::to_string(options.albedo), "give a number above 0 and up to 1");
  if (options.image_size.width < 2 || options.image_size.height < 2)
    refuse_light("the size of the pictures is missing", "give it");
  for (const PanelSpot& spot : spots) {
    if (spot.light < 0 || spot.light >= static_cast<int>(guesses.size())) {
      refuse_light("a spot belongs to light " + std::to_string(spot.light) + ", positions of " +
                       std::to_string(guesses.size()) + " lights were given",
                   "give one guess per light");
    }
    if (spot.picture < 0 || spot.picture >= static_cast<int>(pictures))
      refuse_light("a spot belongs to picture " + std::to_string(spot.picture) + " of " + std::to_string(pictures),
                   "give every picture");
    const bool finite = spot.point.allFinite() && spot.normal.allFinite() && spot.to_camera.allFinite() &&
                        spot.pixel.allFinite() && spot.radiance.allFinite() && spot.sigma.allFinite();
    if (!finite || !(spot.sigma.minCoeff() > 0.0))
      refuse_light("a spot has a measurement that is not a finite number, or no standard error",
                   "leave this picture out");
  }
  for (const LightGuess& guess : guesses)
    if (!guess.position.allFinite() || !guess.aim.allFinite())
      refuse_light("a guessed position is not a finite number", "measure it with a tape");
}

std::vector<LightPicture> named(std::vector<LightPicture> pictures, const std::vector<PanelSpot>& spots) {
  if (pictures.empty())
    for (const PanelSpot& spot : spots)
      while (static_cast<int>(pictures.size()) <= spot.picture && spot.picture < 100000)
        pictures.push_back({.name = "picture " + std::to_string(pictures.size() + 1)});
  for (const LightPicture& picture : pictures)
    if (picture.output && !(*picture.output > 0.0 && std::isfinite(*picture.output) && picture.output_sigma > 0.0))
      refuse_light(picture.name + " has a reading of the lamp's output that is not a positive number", "read it again");
  return pictures;
}

// The spots that face their light. Spots in grazing light tell more about the panel's edge and surface than about
// the light and are left out.
std::vector<PanelSpot> usable(const std::vector<PanelSpot>& spots, const std::vector<LightGuess>& guesses) {
  const double kSmallestCosine = std::sin(5.0 * kDegree);
  std::vector<PanelSpot> out;
  for (PanelSpot spot : spots) {
    spot.normal.normalize();
    spot.to_camera.normalize();
    const Vector3d to_light = (guesses[static_cast<std::size_t>(spot.light)].position - spot.point).normalized();
    const bool bright = (spot.radiance.array() > 3.0 * spot.sigma.array()).all();
    if (bright && to_light.dot(spot.normal) > kSmallestCosine) out.push_back(spot);
  }
  return out;
}

// Refuses pictures with a single direction of the panel, which cannot separate a light's distance from its intensity.
void require_enough(const std::vector<PanelSpot>& used, const std::vector<LightGuess>& guesses) {
  constexpr double kSameDirection = 0.99619;  // cosine of 5 degrees
  for (std::size_t light = 0; light < guesses.size(); ++light) {
    std::size_t count = 0;
    std::vector<int> pictures;
    bool turned = false;
    const PanelSpot* first = nullptr;
    for (const PanelSpot& spot : used) {
      if (spot.light != static_cast<int>(light)) continue;
      if (first == nullptr) first = &spot;
      turned = turned || spot.normal.dot(first->normal) < kSameDirection;
      if (std::find(pictures.begin(), pictures.end(), spot.picture) == pictures.end()) pictures.push_back(spot.picture);
      ++count;
    }
    const std::string name = guesses[light].name;
    if (count < kFewestSpots) {
      refuse_light("the " + name + " lights " + std::to_string(count) + " spots of the panel, at least " +
                       std::to_string(kFewestSpots) + " are needed",
                   "switch it on, turn the panel's face to the lamp and to the camera, and check the lamp's measured "
                   "position");
    }
    if (!turned)
      refuse_light("under the " + name + " the panel was seen in one direction only",
                   "take pictures with the panel turned by 20 to 40 degrees to all sides");
    if (pictures.size() < kFewestPictures)
      refuse_light("under the " + name + " the panel was seen in " + std::to_string(pictures.size()) +
                       " poses, at least " + std::to_string(kFewestPictures) + " are needed",
                   "take pictures with the panel turned to all sides and in two depths");
  }
}

// All results that get a covariance in one vector: positions, log intensity, mu, droop, vignetting, log irradiance at
// the aims.
struct Summary {
  std::size_t lights = 0;
  Eigen::Index positions(std::size_t light) const { return static_cast<Eigen::Index>(3 * light); }
  Eigen::Index intensity() const { return static_cast<Eigen::Index>(3 * lights); }
  Eigen::Index mu() const { return intensity() + 3; }
  Eigen::Index droop() const { return intensity() + 4; }
  Eigen::Index vignetting() const { return intensity() + 6; }
  Eigen::Index aim(std::size_t light) const { return intensity() + 8 + static_cast<Eigen::Index>(light); }

  Eigen::VectorXd of(const Unknowns& x, const LightSolver& solver, const std::vector<LightGuess>& guesses) const {
    Eigen::VectorXd out(intensity() + 8 + static_cast<Eigen::Index>(lights));
    out.segment<4>(intensity()) = x.lamp;
    out.segment<2>(droop()) = x.droop;
    out.segment<2>(vignetting()) = x.vignetting;
    for (std::size_t i = 0; i < lights; ++i) {
      out.segment<3>(positions(i)) = x.positions[i];
      const Vector3d to_aim = guesses[i].aim - x.positions[i];
      const double beam =
          beam_falloff<double>(solver.frame(i).direction(x.beams[i].data()), to_aim.normalized(), x.lamp[3]);
      out[aim(i)] = x.lamp.head<3>().mean() + std::log(beam / to_aim.squaredNorm());
    }
    return out;
  }
};

[[noreturn]] void refuse_dark(const std::string& picture, const std::string& how) {
  refuse_light(picture + " is dark" + how, "switch the lamp on, see that nothing shades the panel, and take it again");
}

// Refuses a picture that faces its light but stays within the noise.
void refuse_unlit_pictures(const std::vector<PanelSpot>& spots, const std::vector<PanelSpot>& used,
                           const std::vector<LightGuess>& guesses, const std::vector<LightPicture>& pictures) {
  std::vector<int> facing(pictures.size(), 0), bright(pictures.size(), 0);
  for (const PanelSpot& spot : spots) {
    const Vector3d to_light = guesses[static_cast<std::size_t>(spot.light)].position - spot.point;
    facing[static_cast<std::size_t>(spot.picture)] +=
        to_light.normalized().dot(spot.normal.normalized()) > std::sin(15.0 * kDegree);
  }
  for (const PanelSpot& spot : used) ++bright[static_cast<std::size_t>(spot.picture)];
  for (std::size_t i = 0; i < pictures.size(); ++i)
    if (2 * bright[i] < facing[i]) refuse_dark(pictures[i].name, "");
}

void refuse_dark_pictures(const LightSolver& solver, const Unknowns& start, const std::vector<LightPicture>& pictures) {
  std::vector<double> brightness;  // measured / expected
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    double sum = 0.0;
    const auto errors = solver.relative_errors(start, static_cast<int>(i));
    for (const Vector3d& error : errors) sum += 1.0 / (1.0 + error.mean());
    if (errors.empty()) continue;
    brightness.push_back(sum / static_cast<double>(errors.size()));
    index.push_back(i);
  }
  const double usual = median(brightness);
  for (std::size_t i = 0; i < brightness.size(); ++i)
    if (brightness[i] < kDarkLimit * usual)
      refuse_dark(pictures[index[i]].name,
                  " beside the others (" + text("%.0f %%", 100 * brightness[i] / usual) + " of what is expected)");
}

// Throws when the pictures leave a light undetermined; the message says in which direction and which pose is missing.
void refuse_weak_light(const LightSolver& solver, const Unknowns& x, std::size_t light, const LightGuess& guess) {
  const std::optional<Eigen::Matrix3d> covariance = solver.position_covariance(x, light);
  if (!covariance)
    refuse_light("the position of the " + guess.name + " is undetermined", "take the whole set of poses");
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(*covariance);
  const double sigma_mm = std::sqrt(axes.eigenvalues()[2]);
  if (sigma_mm < kWeakest_mm) return;
  const Vector3d weak = axes.eigenvectors().col(2);
  Vector3d centre = Vector3d::Zero();
  double count = 0.0;
  for (const PanelSpot& spot : solver.spots())
    if (spot.light == static_cast<int>(light)) centre += spot.point, count += 1.0;
  const Vector3d beam = (x.positions[light] - centre / count).normalized();
  const Vector3d sideways = Vector3d::UnitZ().cross(beam).normalized();
  const std::string found =
      "the poses of the panel leave the " + guess.name + " uncertain by " + text("%.0f mm", sigma_mm) + " in ";
  if (std::abs(weak.dot(beam)) > 0.7)
    refuse_light(found + "distance along its beam",
                 "add poses turned by 30 degrees to either side, at two depths at least 50 mm apart");
  if (std::abs(weak.dot(sideways)) > 0.7)
    refuse_light(found + "direction, sideways", "add poses with the panel turned left and right by 30 degrees");
  refuse_light(found + "direction, up and down", "add poses with the panel tilted up and down by 30 degrees");
}

// Fits without one picture after the other. Adds to `fit` how well each is predicted, and returns the covariance of the
// results by the jackknife.
Eigen::MatrixXd leave_each_out(const LightSolver& solver, const Summary& summary, const Unknowns& x,
                               const std::vector<LightGuess>& guesses, const std::vector<LightPicture>& pictures,
                               LightFit& fit) {
  std::vector<Eigen::VectorXd> results;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int picture = static_cast<int>(i);
    if (solver.relative_errors(x, picture).empty()) continue;
    Unknowns without = x;
    fit.converged = solver.solve(without, picture) && fit.converged;
    results.push_back(summary.of(without, solver, guesses));
    without.log_outputs[i] = pictures[i].output ? std::log(*pictures[i].output) : 0.0;
    HeldOutPicture held{.name = pictures[i].name, .output = std::exp(x.log_outputs[i])};
    const auto errors = solver.relative_errors(without, picture);
    for (const Vector3d& error : errors) {
      held.spot_error += error.squaredNorm() / 3.0;
      held.picture_error += error.mean();
    }
    held.spot_error = std::sqrt(held.spot_error / static_cast<double>(errors.size()));
    held.picture_error /= static_cast<double>(errors.size());
    for (const PanelSpot& spot : solver.spots())
      if (spot.picture == picture) held.light = spot.light;
    fit.held_out.push_back(held);
  }
  const auto n = static_cast<double>(results.size());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(results.front().size());
  for (const Eigen::VectorXd& result : results) mean += result / n;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(mean.size(), mean.size());
  for (const Eigen::VectorXd& result : results)
    covariance += (n - 1) / n * (result - mean) * (result - mean).transpose();
  return covariance;
}

// One gate over all pictures, with the largest value and the names of the pictures beyond the limit.
class PictureGate {
 public:
  PictureGate(const char* name, double limit_percent) : gate_(at_most(name, 0.0, limit_percent, "")) {}

  void add(const std::string& picture, double relative) {
    gate_.value = std::max(gate_.value, 100 * relative);
    if (!(100 * relative <= gate_.limit)) names_ += (names_.empty() ? "" : ", ") + picture;
  }
  Gate result(const std::string& what, const std::string& what_to_do) const {
    return at_most(gate_.name, gate_.value, gate_.limit,
                   (names_.empty() ? "the worst picture" : names_) + ": " + what + " by up to " +
                       text("%.1f %%", gate_.value) + "; " + what_to_do);
  }

 private:
  Gate gate_;
  std::string names_;
};

void add_picture_gates(const LightSolver& solver, const Unknowns& x, const std::vector<LightPicture>& pictures,
                       LightFit& fit) {
  PictureGate output("lamp output in one picture, off by %", 100 * kOutputLimit),
      residual("spots of the panel in one picture, rms error %", 100 * kResidualLimit);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const auto errors = solver.relative_errors(x, static_cast<int>(i));
    if (errors.empty()) continue;
    output.add(pictures[i].name, std::abs(std::exp(x.log_outputs[i]) / pictures[i].output.value_or(1.0) - 1.0));
    double sum = 0.0;
    for (const Vector3d& error : errors) sum += error.squaredNorm() / 3.0;
    residual.add(pictures[i].name, std::sqrt(sum / static_cast<double>(errors.size())));
  }
  fit.gates.push_back(
      output.result("off in brightness",
                    "switch the room light off, let the lamp warm up and leave it where it is, take them again"));
  fit.gates.push_back(residual.result("not like a panel under one lamp",
                                      "look for a shadow, a stain, room light or a moved lamp, take them again"));
}

void add_gates(const LightSolver& solver, const Unknowns& x, const std::vector<LightGuess>& guesses,
               const std::vector<LightPicture>& pictures, LightFit& fit) {
  add_picture_gates(solver, x, pictures, fit);
  for (std::size_t light = 0; light < guesses.size(); ++light) {
    const double error = held_out_error(fit, static_cast<int>(light));
    fit.gates.push_back(at_most(
        guesses[light].name + ", held-out panel pictures, rms error %", 100 * error, 100 * kHeldOutLimit,
        "panel pictures under the " + guesses[light].name + " are predicted from the others to " +
            text("%.2f %%", 100 * error) +
            " only: let the lamp warm up, leave it where it is, switch the room light off and take them again"));
    const double off = (x.positions[light] - guesses[light].position).norm();
    fit.gates.push_back(at_most(guesses[light].name + ", distance from the tape's position mm", off, kTapeLimit_mm,
                                "the " + guesses[light].name + " is found " + text("%.0f mm", off) +
                                    " from where the tape put it: measure again, or look for a second light"));
  }
}

void take_covariances(const Summary& summary, const Eigen::MatrixXd& covariance, LightFit& fit) {
  fit.position_covariances.clear();
  for (std::size_t i = 0; i < summary.lights; ++i) {
    fit.position_covariances.push_back(covariance.block<3, 3>(summary.positions(i), summary.positions(i)));
    fit.aim_irradiance_sigma.push_back(std::sqrt(covariance(summary.aim(i), summary.aim(i))));
  }
  fit.intensity_covariance = fit.intensity.asDiagonal() *
                             covariance.block<3, 3>(summary.intensity(), summary.intensity()) *
                             fit.intensity.asDiagonal();
  fit.vignetting_covariance = covariance.block<2, 2>(summary.vignetting(), summary.vignetting());
  fit.beam_exponent_sigma = std::sqrt(covariance(summary.mu(), summary.mu()));
  fit.droop_sigma = covariance.diagonal().segment<2>(summary.droop()).cwiseSqrt();
}

}  // namespace

double held_out_error(const LightFit& fit, int light) {
  double sum = 0.0, count = 0.0;
  for (const HeldOutPicture& held : fit.held_out)
    if (held.light == light) sum += held.picture_error * held.picture_error, count += 1.0;
  return std::sqrt(sum / count);
}

Vector3d facing_irradiance(const LightFit& fit, std::size_t light, const Vector3d& point) {
  const Vector3d from_light = point - fit.positions.at(light);
  return fit.intensity * (beam_falloff<double>(fit.beam_axes.at(light), from_light.normalized(), fit.beam_exponent) /
                          from_light.squaredNorm());
}

double panel_factor(const Vector2d& droop, const Vector3d& normal, const Vector3d& to_light,
                    const Vector3d& to_camera) {
  return panel_factor<double>(to_light.dot(normal), to_light, normal, to_camera, droop.data());
}

LightFit fit_light(const std::vector<PanelSpot>& spots, const std::vector<LightGuess>& guesses,
                   const LightOptions& options, const std::vector<LightPicture>& given_pictures) {
  const std::vector<LightPicture> pictures = named(given_pictures, spots);
  check(spots, guesses, options, pictures.size());
  const std::vector<PanelSpot> used = usable(spots, guesses);
  require_enough(used, guesses);
  refuse_unlit_pictures(spots, used, guesses, pictures);
  const LightSolver solver(used, guesses, options, pictures);
  Unknowns x = solver.first_guess();
  refuse_dark_pictures(solver, x, pictures);
  LightFit fit;
  fit.converged = solver.solve(x);
  for (std::size_t light = 0; light < guesses.size(); ++light) refuse_weak_light(solver, x, light, guesses[light]);
  fit.positions = x.positions;
  for (std::size_t light = 0; light < guesses.size(); ++light)
    fit.beam_axes.push_back(solver.frame(light).direction(x.beams[light].data()));
  fit.beam_exponent = x.lamp[3];
  fit.intensity = solver.seed().array() * x.lamp.head<3>().array().exp();
  fit.droop = x.droop;
  fit.table_albedo = x.table;
  fit.vignetting = {.v0 = x.vignetting[0], .v1 = x.vignetting[1]};
  fit.spots_used = static_cast<int>(used.size());
  double relative = 0.0;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    for (const Vector3d& error : solver.relative_errors(x, static_cast<int>(i))) relative += error.squaredNorm();
  fit.relative_rms = std::sqrt(relative / (3.0 * static_cast<double>(used.size())));

  const Summary summary{guesses.size()};
  Eigen::MatrixXd covariance = leave_each_out(solver, summary, x, guesses, pictures, fit);
  LightOptions published = options;
  published.published_droop_only = true;
  Unknowns y = x;
  y.droop[1] = 0.0;
  const LightSolver other(used, guesses, published, pictures);
  other.solve(y);
  const Eigen::VectorXd shift = summary.of(y, other, guesses) - summary.of(x, solver, guesses);
  covariance += shift * shift.transpose();
  take_covariances(summary, covariance, fit);
  add_gates(solver, x, guesses, pictures, fit);
  return fit;
}

}  // namespace calibration
