// Synthetic truth for the light calibration: a bench with one flashlight in two places, and what a camera reads off a
// Spectralon panel there, with the errors of real readings.
#pragma once

#include <random>
#include <vector>

#include "calibration/light/light.h"
#include "calibration/light/light_plan.h"
#include "calibration/sensor/degree.h"

namespace calibration::synthetic {

struct LampTruth {
  std::vector<Eigen::Vector3d> positions{{318, 116, 368}, {-335, 90, 335}};  // lamp in front, lamp behind
  std::vector<Eigen::Vector3d> axes{{-318, -116, -304}, {335, -90, -271}};
  double mu = 1.0;
  Eigen::Vector3d intensity{2.5e6, 3.2e6, 2.3e6};
  double droop = 0.08;
  double table_albedo = 0.03;            // albedo of the plane z = 0
  bool droop_of_incidence_only = false;  // 1 + droop * 2 (cos theta_i - cos 8 deg), not the published shape
  Vignetting vignetting{.v0 = -0.18, .v1 = -0.03};
};

// A random truth for the statistics: mu 0 to 2, droop 0 to 15 %, table albedo 0 to 6 %, beams aimed within 3 degrees,
// lamps moved by up to 30 mm per axis.
LampTruth drawn_truth(std::mt19937& random);

// The true irradiance, perpendicular to the light, at a point; written independently of calibration's own model.
Eigen::Vector3d true_irradiance(const LampTruth& truth, std::size_t light, const Eigen::Vector3d& point);

struct Imperfections {
  double noise = 0.003;             // of a spot's reading
  double drift = 0.005;             // change of the lamp's output from picture to picture
  double turn_rad = 0.1 * kDegree;  // error of the panel's pose, per axis
  double shift_mm = 0.1;
  double monitored = 0.0;  // error of the reference chip's reading; 0: no spot is read
};

struct PanelPictures {
  std::vector<PanelSpot> spots;
  std::vector<LightPicture> pictures;
};

// Guesses by tape: positions wrong by `error_mm` (standard deviation) per axis, beams aimed at the spool.
std::vector<LightGuess> taped(const LampTruth& truth, std::mt19937& random, double error_mm = 15);

PanelBench panel_bench();
std::vector<Eigen::Isometry3d> panel_stands();  // platform_from_panel on each

// The panel's poses as planned for a bench with such lights. A hand that wanders puts each stand down within 30 mm each
// way and 15 degrees of where it should be; the angles are then planned for where it stands. Where it cannot be seen
// from there as planned, the hand is asked once more.
struct PlannedPoses {
  std::vector<PanelPose> poses;
  int mountings = 0, asked_again = 0;
};
PlannedPoses planned_poses(const std::vector<LightGuess>& guesses, const std::vector<MountingCounts>& counts,
                           std::mt19937* wandering = nullptr);

LightOptions panel_options();

PanelPictures panel_pictures(const LampTruth& truth, const std::vector<PanelPose>& poses,
                             const Imperfections& imperfections, std::mt19937& random);

}  // namespace calibration::synthetic
