// Calibrated cameras as the renderer uses them, and reading pictures for calibration.
#pragma once

#include <Eigen/Geometry>

#include "calibration/lens.h"
#include "calibration/sensor_file.h"
#include "calibration/tags.h"
#include "renderer/camera.h"
#include "rig/simulated_bench.h"

namespace station {

// The renderer's camera for a calibrated lens; `undistorted` for pictures whose distortion has been removed.
renderer::Camera camera_of(const calibration::Lens& lens, const Eigen::Isometry3d& frame_from_camera,
                           bool undistorted);

// The simulated bench's lens in the words of calibration.
calibration::Lens lens_of(const rig::TrueLens& lens);

// Tags in a raw picture (linear grey of the demosaiced picture, distortion left in).
calibration::TagObservation tags_in(const calibration::SensorPicture& picture);

}  // namespace station
