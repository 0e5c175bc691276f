// The merging of one or several exposures of a still scene into one linear mosaic, in which each raw value counts
// according to its noise.
//
// A value x = light / t (t: exposure time) has the weight t^2 / variance of the light, which is the usual
// (t g)^2 / (g DN + sigma_r^2). The variance is taken at the mean of all exposures, because weights from each value's
// own noise would favour values that came out low. The weight is 0 above 0.92 of the range and beside (3 x 3) a
// saturated value; where no exposure is left, the shortest is taken as it is.
#pragma once

#include <array>
#include <vector>

#include "calibration/sensor/sensor_file.h"
#include "calibration/sensor/sensor_response.h"

namespace calibration {

struct LinearMosaic {
  cv::Mat1f radiance;            // radiance unit, dust taken out, vignetting left in; still the sensor's mosaic
  cv::Mat1f variance;            // variance of the radiance; empty when the response has no gain
  cv::Mat1b saturated;           // 255: above 0.98 of the range even in the shortest exposure
  std::array<int, 4> channel{};  // colours of the 2 x 2 cell
};

// Throws std::runtime_error when sizes, ISO, levels or mosaics differ, or a map has another size.
void require_mergeable(const std::vector<SensorPicture>& bracket, const SensorResponse& response);

// The merged mosaic. `dark_offset_dn` is added to every dark level (a drift of the bias that dark frames of the day
// showed). Errors: those of require_mergeable.
LinearMosaic merge_exposures(const std::vector<SensorPicture>& bracket, const SensorResponse& response,
                             double dark_offset_dn = 0.0);

// Replaces bad pixels by the mean of good neighbours of their colour, in opposite pairs where possible, so that a slope
// across the pixel is kept. Bad pixels without a good neighbour count as saturated.
void repair_bad_pixels(const cv::Mat1b& bad, LinearMosaic& mosaic);

}  // namespace calibration
