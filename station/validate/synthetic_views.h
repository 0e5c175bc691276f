// The 17 views of a spool as an ideal station would have them: geometry, lamps and lens of the simulated rig's truth, so
// that what a fit gets wrong is the fit's and not a calibration's. Photographs are path-traced from the spool's fibers.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "inversion/view.h"
#include "renderer/cloth_shape.h"
#include "renderer/scene.h"
#include "rig/simulated_bench.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

inline constexpr int kPooledWidth_px = 256, kPooledHeight_px = 192;
inline constexpr double kPhotographLevel = 0.5;  // of full scale, of one in a thousand pixels

// The rig's plan at width x height pixels, distortion removed: the whole width of the sensor is shown. Masks are made,
// images are not. With `calibrated` camera, axis and lamps are where a calibration of the rig takes them to be, on the
// pixels of the true views: what its errors do to a fit is the difference.
// Errors: std::runtime_error when the rig has no simulation.
std::vector<inversion::View> synthetic_views(const RigFile& rig, const inversion::WrappedSpool& spool, int width_px,
                                             int height_px, const RigCalibration* calibrated = nullptr);

// Of a cloth on the black cylinder in the middle of the platform: "right" and "left", by where the lamp stands; camera and
// lamp in the cylinder's frame (cloth_on_cylinder.h), the mask its lit side. Errors: as above.
std::vector<inversion::View> cylinder_views(const RigFile& rig, const renderer::CylinderShape& cylinder, int width_px,
                                            int height_px);

struct PhotographOptions {
  int samples_per_pixel = 256;
  std::uint64_t seed = 1;
  std::function<bool(double)> progress{};  // false stops
};

// Radiance inside the view's mask, without the sensor's noise.
cv::Mat3f photograph(const inversion::View& view, const inversion::WrappedSpool& spool,
                     const renderer::CurveSet& curves, const PhotographOptions& options);

struct SensedPicture {
  cv::Mat3f radiance;
  inversion::NoiseLaw noise;
};

// A picture as a 14-bit sensor gives it: exposed so that one in a thousand masked pixels reaches `target_level` of full
// scale, with the noise of counted electrons and of reading, quantised.
SensedPicture with_sensor_noise(const cv::Mat3f& radiance, const cv::Mat1b& mask, const rig::TrueSensor& sensor,
                                double target_level, std::uint64_t seed);

}  // namespace station
