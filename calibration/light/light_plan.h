// The plan of the poses of the Spectralon panel that determine the lights best: a greedy choice from a grid of
// admissible poses.
//
// In an admissible pose light and camera are within 45 degrees of the panel's normal (or, where lamp and camera stand
// too far apart for that, within 12 degrees of the smallest possible angle and 70 degrees at most), the camera is more
// than 20 degrees off the mirror direction, at least two of the panel's tags are in the picture, and the plate is clear
// of the platform. Poses are chosen one by one: each is the one after which the lights' positions and the vignetting
// are known best, for spots good to 0.3 %, a lamp that drifts as expected, and the priors of the fit (light.h).
#pragma once

#include <vector>

#include "calibration/geometry/tags.h"
#include "calibration/light/light.h"

namespace calibration {

struct PanelBench {
  Lens lens;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  double white_mm = 50, plate_mm = 88;  // edges of the white square and of the plate, centred on the panel's frame
  TagLayout tags;                       // in the panel's frame: x right, y up, z the face's normal
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // about where the panel is held; world, mm
  double lowest_mm = 0;                              // world z that the plate must stay above
};

struct PanelPose {
  int light = 0;
  Eigen::Isometry3d world_from_panel = Eigen::Isometry3d::Identity();
};

// The chosen poses, `counts` of them under each light, in the order of the lights. Throws std::runtime_error, naming
// the light, when no pose is admissible.
std::vector<PanelPose> plan_panel_poses(const PanelBench& bench, const std::vector<LightGuess>& lights,
                                        const std::vector<int>& counts, const LightOptions& options);

// The edge of a cell (mm) and the centres (panel frame, mm) of the panel's n x n cells, which cover the middle 84 % of
// the white square.
double panel_cell_mm(double white_mm, int n);
std::vector<Eigen::Vector3d> panel_cells(double white_mm, int n);

}  // namespace calibration
