// The radiance of the Spectralon panel, cell by cell, from one picture in which its pose is known by its tags.
#pragma once

#include <vector>

#include "calibration/develop/develop.h"
#include "calibration/geometry/pose.h"
#include "calibration/light/light.h"
#include "calibration/sensor/sensor_response.h"
#include "station/documents/rig_file.h"

namespace station {

// The cells of the panel; those that leave the picture or are saturated are left out. `light` is 0 for the lamp in
// front and 1 for the one behind, `number` counts the pictures of both. `picture` is not flat-fielded and has the
// distortion.
std::vector<calibration::PanelSpot> panel_spots(const calibration::Developed& picture, const calibration::Lens& lens,
                                                const Eigen::Isometry3d& world_from_camera,
                                                const Eigen::Isometry3d& camera_from_panel,
                                                const SpectralonPanel& panel, int light, int number);

}  // namespace station
