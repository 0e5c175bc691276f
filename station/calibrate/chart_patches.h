// The patches of the colour chart in a picture, as the colour fit takes them.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibration/develop.h"
#include "calibration/light.h"
#include "station/documents/rig_file.h"

namespace station {

// Mean of each patch over what a perfect diffuser in its place would show, RGB. `picture`: flat-fielded, distortion left
// in; NaN for a patch that is saturated or not in the picture.
std::vector<Eigen::Vector3d> chart_colours(const calibration::Developed& picture, const calibration::Lens& lens,
                                           const Eigen::Isometry3d& world_from_camera,
                                           const Eigen::Isometry3d& camera_from_chart, const ColourChart& chart,
                                           const calibration::LightFit& light);

}  // namespace station
