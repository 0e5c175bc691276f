// Calibrated cameras as the renderer uses them, and reading pictures for calibration.
#pragma once

#include <Eigen/Geometry>

#include "calibration/lens.h"
#include "calibration/sensor_file.h"
#include "calibration/tags.h"
#include "renderer/camera.h"

namespace station {

// The renderer's camera for a calibrated lens; `undistorted` for pictures whose distortion has been removed.
renderer::Camera camera_of(const calibration::Lens& lens, const Eigen::Isometry3d& frame_from_camera,
                           bool undistorted);

// Tags in a raw picture (linear grey of the demosaiced picture, distortion left in).
calibration::TagObservation tags_in(const calibration::SensorPicture& picture);

}  // namespace station
