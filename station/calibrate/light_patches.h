// Radiance of the Spectralon panel, cell by cell, from one picture whose pose is known from the panel's tags.
#pragma once

#include <vector>

#include "calibration/develop.h"
#include "calibration/light.h"
#include "calibration/pose.h"
#include "calibration/sensor_response.h"
#include "station/documents/rig_file.h"

namespace station {

// `light`: 0 front, 1 back; `number`: of the picture, among those of the lights; `picture`: not flat-fielded, distortion left in.
// Cells that leave the picture or are saturated are left out.
std::vector<calibration::LightPatch> panel_patches(const calibration::Developed& picture,
                                                   const calibration::Lens& lens,
                                                   const Eigen::Isometry3d& world_from_camera,
                                                   const Eigen::Isometry3d& camera_from_panel,
                                                   const SpectralonPanel& panel, int light, int number);

}  // namespace station
