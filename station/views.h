// Calibrated cameras as the renderer uses them, and reading pictures for calibration.
#pragma once

#include <Eigen/Geometry>

#include "calibration/lens.h"
#include "calibration/sensor_file.h"
#include "calibration/tags.h"
#include "inversion/view.h"
#include "renderer/camera.h"
#include "rig/simulated_bench.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

// The renderer's camera for a calibrated lens; `undistorted` for pictures whose distortion has been removed.
renderer::Camera camera_of(const calibration::Lens& lens, const Eigen::Isometry3d& frame_from_camera,
                           bool undistorted);

// The simulated bench's lens in the words of calibration.
calibration::Lens lens_of(const rig::TrueLens& lens);

// Grey of a raw picture: mean of the demosaiced colours, linear, distortion left in, nothing below zero.
cv::Mat1f linear_grey(const calibration::SensorPicture& picture);
// The calibrated lamp where it stands, as the fit of the threads sees it; in front on the left it is calibrated but for its
// place, which is the rig file's.
inversion::NearLight lamp_in_holder(const RigCalibration& calibration, const RigFile& rig, rig::Lamp place,
                                    const Eigen::Isometry3d& holder_from_world);

// Tags in a raw picture (linear grey of the demosaiced picture, distortion left in).
calibration::TagObservation tags_in(const calibration::SensorPicture& picture);

}  // namespace station
