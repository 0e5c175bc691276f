// Measures of one picture that tell whether it serves: sharpness, blur of printed edges, motion between two pictures.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calibration/geometry/tags.h"
#include "calibration/sensor/sensor_file.h"

namespace station {

// The detail of one to three pixels in `region` (255 inside), relative to the light there; from medians, so that hot
// pixels and glints do not count. The value means nothing by itself; views of the same threads under the same lamp can
// be compared by it.
double sharpness(const cv::Mat1f& linear_grey, const cv::Mat1b& region);

// The blur of printed edges beyond which a picture is doubtful, and beyond which it is bad.
inline constexpr double kDoubtfulBlur_px = 2, kBadBlur_px = 3;

// The standard deviation (px) of the blur of the tags' black edges, median over the edges; lens, focus, motion and
// demosaicing all add to it. Tags with edges below 16 px are left out, because neighbouring edges run together; nothing
// when no edge is left.
std::optional<double> edge_blur_px(const cv::Mat1f& linear_grey, const calibration::TagObservation& tags);

// How far the tags that both pictures show have moved, px: the median over their corners. Nothing without two such
// tags.
std::optional<double> motion_px(const calibration::TagObservation& before, const calibration::TagObservation& after);

// The part of the region's raw pixels that are above 98 % of the range.
double saturated_fraction(const calibration::SensorPicture& picture, const cv::Mat1b& region);

}  // namespace station
