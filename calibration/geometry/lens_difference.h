// The comparison of two calibrated lenses where they are used: in the inner picture, which is the inner two thirds of
// rows and columns, where spools stand and boards were seen.
#pragma once

#include "calibration/geometry/mrcal_lens.h"

namespace calibration {

// How far apart (px) the two lenses project the same points at one distance, over the inner picture.
struct LensDifference {
  double median_px = 0.0, rms_px = 0.0, largest_px = 0.0;
};

// The size of the grid of positions, spread evenly from the first to the last pixel, at which lenses are compared and
// the uncertainty of projections is given.
constexpr int kGridColumns = 12, kGridRows = 9;

// The grid's positions (px), row by row, as in LensFit::projection_sigma_px.
std::vector<Eigen::Vector2d> picture_grid(const cv::Size& image_size);

// Whether the i-th position of the grid lies in the inner picture.
bool is_inner(std::size_t i);

// The distance (px), at each position of the grid, between the projections of a point at `distance_mm` by the two
// lenses, after the rigid motion between their cameras that fits best over the inner picture. The motion is allowed
// because repeated calibrations place their cameras differently, and in use poses are measured with the same lens.
std::vector<double> projection_differences(const ModelledLens& a, const ModelledLens& b, double distance_mm);

// The differences summed up over the inner picture.
LensDifference summary(const std::vector<double>& differences_px);

}  // namespace calibration
