// The adapter between a calibrated camera and those who use it: the renderer, the fit, and the search for tags in its
// pictures.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>

#include "calibration/geometry/lens.h"
#include "calibration/geometry/tags.h"
#include "calibration/sensor/sensor_file.h"
#include "inversion/view/view.h"
#include "renderer/picture/camera.h"
#include "rig/simulated/simulated_bench.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

// The renderer's camera for a calibrated lens; `undistorted` for pictures whose distortion has been removed.
renderer::Camera camera_of(const calibration::Lens& lens, const Eigen::Isometry3d& frame_from_camera, bool undistorted);

// The simulated bench's lens as calibration describes lenses.
calibration::Lens lens_of(const rig::TrueLens& lens);

// The calibrated lamp at one of its places, as the fit of the threads sees it. In front on the left its place is the
// rig file's, and all else is calibrated.
inversion::NearLight lamp_in_holder(const RigCalibration& calibration, const RigFile& rig, rig::Lamp place,
                                    const Eigen::Isometry3d& holder_from_world);

// The f-number that a picture was taken at: the file's own, or the one that every camera is asked for when the file
// does not tell it, because the lens has no electronic aperture.
double f_number_of(const calibration::SensorPicture& picture);

// True when the file's name ends as those of raw pictures do, in capitals or not.
bool is_raw_file(const std::filesystem::path& file);

// The tags in a raw picture, found in its grey (calibration/develop/linear_grey.h).
calibration::TagObservation tags_in(const calibration::SensorPicture& picture);

}  // namespace station
