// One linear mosaic from one or several exposures of the same still scene, each raw value weighted by what it knows.
//
// Weight of a value x = light / time: (t g)^2 / (g DN + sigma_r^2), in this file t^2 / variance of the light, with the
// variance taken at the mean of all exposures: weights from each value's own noise would favour values that came out low.
// Weight 0 above 0.92 of the range and beside (3 x 3) a saturated value; where no exposure is left the shortest is
// taken as it is.
#pragma once

#include <array>
#include <vector>

#include "calibration/sensor_file.h"
#include "calibration/sensor_response.h"

namespace calibration {

struct LinearMosaic {
  cv::Mat1f radiance;            // radiance unit, dust taken out, vignetting left in; still the sensor's mosaic
  cv::Mat1f variance;            // of it; empty when the response has no gain
  cv::Mat1b saturated;           // 255: above 0.98 of the range even in the shortest exposure
  std::array<int, 4> channel{};  // colours of the 2 x 2 cell
};

// Throws std::runtime_error when sizes, ISO, levels or mosaics differ, or a map has another size.
void require_mergeable(const std::vector<SensorPicture>& bracket, const SensorResponse& response);

// `dark_offset_dn`: added to every dark level (a drift of the bias that dark frames of the day showed). Throws
// as require_mergeable.
LinearMosaic merge_exposures(const std::vector<SensorPicture>& bracket, const SensorResponse& response,
                             double dark_offset_dn = 0.0);

// Bad pixels become the mean of good neighbours of their colour, on both sides where that is possible, so that a slope
// across them stays; those without any good neighbour count as saturated.
void repair_bad_pixels(const cv::Mat1b& bad, LinearMosaic& mosaic);

}  // namespace calibration
