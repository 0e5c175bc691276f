// The fit of a matrix from camera colours to linear sRGB to a picture of a 24-square colour chart, with the colour
// differences that remain.
//
// Reference colours: CIE L*a*b* under D50, 2 degrees, of the chart's maker (ColorChecker Classic, charts made after
// November 2014). sRGB is D65: adapted by Bradford's matrix (ICC.1:2022, annex E). Colour difference: CIEDE2000
// (Sharma, Wu, Dalal 2005).
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "calibration/sensor/gate.h"

namespace calibration {

struct ChartSquare {
  std::string name;
  Eigen::Vector3d lab_d50;
};

// The chart's squares along rows, from the brown one to the black one.
const std::array<ChartSquare, 24>& colour_chart();

Eigen::Vector3d linear_srgb_of_lab(const Eigen::Vector3d& lab_d50);
Eigen::Vector3d lab_of_linear_srgb(const Eigen::Vector3d& linear_srgb);  // values below 0 (outside of sRGB) are allowed
double delta_e_2000(const Eigen::Vector3d& lab, const Eigen::Vector3d& other_lab);

struct ColourFit {
  Eigen::Matrix3d linear_srgb_from_camera = Eigen::Matrix3d::Identity();
  std::vector<double> delta_e;  // CIEDE2000 of each square
  double mean_delta_e = 0.0, largest_delta_e = 0.0;
  std::vector<Gate> gates;
};

// Fits the matrix with the least sum of squared Lab differences that keeps white (its rows sum to 1). `camera`: one
// linear RGB per square in the chart's order, each channel divided by that of a perfect diffuser in the same place and
// light, so that grey is grey. Throws std::runtime_error when squares are missing or not finite, or their colours
// cannot be this chart's (it was held upside down, or is another chart).
ColourFit fit_colours(const std::vector<Eigen::Vector3d>& camera);

}  // namespace calibration
