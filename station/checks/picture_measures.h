// Figures of one picture that say whether it serves: sharpness, blur of printed edges, motion between two pictures.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calibration/sensor_file.h"
#include "calibration/tags.h"

namespace station {

// Detail of one to three pixels in `region` (255 inside), relative to its light; medians, so that hot pixels and sparkles
// have no say. Means nothing by itself; views of the same threads under the same lamp compare.
double sharpness(const cv::Mat1f& linear_grey, const cv::Mat1b& region);

// Standard deviation (px) of the blur of the tags' black edges, median over the edges: lens, focus, motion and
// demosaicing together. Edges of tags below 16 px run into their neighbours: nothing.
std::optional<double> edge_blur_px(const cv::Mat1f& linear_grey, const calibration::TagObservation& tags);

// How far the tags that both pictures show have moved, px: the median over their corners. Nothing without two tags.
std::optional<double> motion_px(const calibration::TagObservation& before, const calibration::TagObservation& after);

// Part of the region's raw pixels above 98 % of the range.
double saturated_fraction(const calibration::SensorPicture& picture, const cv::Mat1b& region);

}  // namespace station
