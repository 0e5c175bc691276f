// The 17 views of a spool as an ideal station would have them: geometry, lamps and lens are the simulated rig's truth,
// so that an error is the fit's own and not a calibration's. Photographs are path-traced from the spool's fibers.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "inversion/view/view.h"
#include "renderer/scene/cloth_shape.h"
#include "renderer/scene/scene.h"
#include "rig/simulated/simulated_bench.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

inline constexpr int kPooledWidth_px = 256, kPooledHeight_px = 192;
inline constexpr double kPhotographLevel = 0.5;  // of full scale; one in a thousand pixels is brighter

// The views of the rig's plan at width x height pixels, without distortion and over the whole width of the sensor.
// Their masks are made, their images are not. With `calibrated`, camera, axis and lamps are where a calibration of the
// rig puts them, on the pixels of the true views; the difference shows what its errors do to a fit. Errors:
// std::runtime_error when the rig has no simulation.
std::vector<inversion::View> synthetic_views(const RigFile& rig, const inversion::WrappedSpool& spool, int width_px,
                                             int height_px, const RigCalibration* calibrated = nullptr);

// The views of a cloth on the black cylinder in the middle of the platform: "right" and "left", by where the lamp
// stands. Camera and lamp are in the cylinder's frame (cloth_on_cylinder.h); the mask is its lit side. Errors: as
// above.
std::vector<inversion::View> cylinder_views(const RigFile& rig, const renderer::CylinderShape& cylinder, int width_px,
                                            int height_px);

// A flat swatch that stands upright on the platform, its face towards the camera, and its view from there with the lamp
// behind it. The mask is the swatch's middle, away from its borders; the frame is that of cylinder_views. Errors: as
// above.
struct BackLitSwatch {
  renderer::SwatchShape shape;
  Eigen::Isometry3d frame_from_swatch;
  inversion::View view;
};
BackLitSwatch back_lit_swatch(const RigFile& rig, int width_px, int height_px);

struct PhotographOptions {
  int samples_per_pixel = 256;
  std::uint64_t seed = 1;
  std::function<bool(double)> progress{};  // false stops
};

// Path-traces a photograph: radiance inside the view's mask, without the sensor's noise.
cv::Mat3f photograph(const inversion::View& view, const inversion::WrappedSpool& spool,
                     const std::vector<renderer::CurveSet>& curves, const PhotographOptions& options);

struct SensedPicture {
  cv::Mat3f radiance;
  inversion::NoiseLaw noise;
};

// The picture as a 14-bit sensor gives it: exposed so that one in a thousand masked pixels is above `target_level` of
// full scale, with the noise of counted electrons and of reading, quantised. Also returned is the law of that noise.
SensedPicture with_sensor_noise(const cv::Mat3f& radiance, const cv::Mat1b& mask, const rig::TrueSensor& sensor,
                                double target_level, std::uint64_t seed);

}  // namespace station
