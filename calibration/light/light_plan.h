// The plan of the poses of the Spectralon panel that determine the lights best: which stands hold it on the platform
// under which light, and to which angles the platform turns them.
//
// In an admissible pose light and camera are within 45 degrees of the panel's normal (or, where lamp and camera stand
// too far apart for that, within 12 degrees of the smallest possible angle and 70 degrees at most), the camera is more
// than 20 degrees off the mirror direction, at least two of the panel's tags are in the picture, and the plate is clear
// of the platform. Of these, poses are chosen one by one: each is the one after which the lights' positions and the
// vignetting are known best, for spots good to 0.3 %, a lamp that drifts as expected, and the priors of the fit
// (light.h).
#pragma once

#include <vector>

#include "calibration/geometry/board_plan.h"
#include "calibration/geometry/tags.h"
#include "calibration/light/light.h"

namespace calibration {

struct PanelBench {
  RoughCamera camera;
  double white_mm = 50, plate_mm = 88;  // edges of the white square and of the plate, centred on the panel's frame
  TagLayout tags;                       // in the panel's frame: x right, y up, z the face's normal
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // about where the panel stands; world, mm
  double lowest_mm = 0;                              // world z that the plate must stay above
};

struct PanelPose {
  int light = 0;
  Eigen::Isometry3d world_from_panel = Eigen::Isometry3d::Identity();
};

// The panel on one of the stands, and the angles to which the platform turns it, in rising order.
struct PanelMounting {
  int light = 0;
  int stand = 0;                                                          // its index
  Eigen::Isometry3d platform_from_panel = Eigen::Isometry3d::Identity();  // platform frame at angle 0 = world
  std::vector<double> angles_rad;
};

struct MountingCounts {
  int mountings = 2;  // each on another stand
  int pictures = 8;   // of each mounting
};

// The mountings, as many as `counts` says for each light, in the order of the lights; `stands`: platform_from_panel on
// each stand. The platform turns by `limit_rad` at most either way. Throws std::runtime_error, naming the light, when
// no stand shows the panel to light and camera.
std::vector<PanelMounting> plan_panel_mountings(const PanelBench& bench, const std::vector<LightGuess>& lights,
                                                const std::vector<Eigen::Isometry3d>& stands,
                                                const std::vector<MountingCounts>& counts, double limit_rad,
                                                const LightOptions& options);

// The angles for a panel that stands as `platform_from_panel` says, after the poses of `earlier`; fewer than `count`
// when fewer show it.
std::vector<double> plan_panel_angles(const PanelBench& bench, const std::vector<LightGuess>& lights,
                                      const std::vector<PanelPose>& earlier, int light,
                                      const Eigen::Isometry3d& platform_from_panel, int count, double limit_rad,
                                      const LightOptions& options);

// The edge of a cell (mm) and the centres (panel frame, mm) of the panel's n x n cells, which cover the middle 84 % of
// the white square.
double panel_cell_mm(double white_mm, int n);
std::vector<Eigen::Vector3d> panel_cells(double white_mm, int n);

}  // namespace calibration
