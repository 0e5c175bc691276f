// How far two calibrated lenses disagree where they are used.
#pragma once

#include "calibration/lens.h"
#include "calibration/mrcal_lens.h"

namespace calibration {

// The positions of LensFit::projection_sigma_px, row by row.
std::vector<Eigen::Vector2d> picture_grid(const cv::Size& image_size);

// Whether the i-th of them lies within the inner two thirds of rows and columns, where spools stand and boards were seen.
bool is_inner(std::size_t i);

// Per grid position, px. The rigid motion between the cameras is the one that fits best over the inner picture: repeated
// calibrations place their camera differently, and whoever uses them measures poses with the same lens.
std::vector<double> projection_differences(const ModelledLens& a, const ModelledLens& b, double distance_mm);

// Over the inner picture.
LensDifference summary(const std::vector<double>& differences_px);

}  // namespace calibration
