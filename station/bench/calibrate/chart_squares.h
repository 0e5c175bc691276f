// The squares of the colour chart in a picture, as the colour fit takes them.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibration/develop/develop.h"
#include "calibration/light/light.h"
#include "station/documents/rig_file.h"

namespace station {

// The mean of each square over what a perfect diffuser in its place would show, RGB; NaN for a square that is saturated
// or not in the picture. `picture` is flat-fielded and has the lens's distortion.
std::vector<Eigen::Vector3d> chart_colours(const calibration::Developed& picture, const calibration::Lens& lens,
                                           const Eigen::Isometry3d& world_from_camera,
                                           const Eigen::Isometry3d& camera_from_chart, const ColourChart& chart,
                                           const calibration::LightFit& light);

}  // namespace station
