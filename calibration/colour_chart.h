// Camera colours to linear sRGB from a picture of a 24-patch colour chart, with the colour difference that remains.
//
// Reference colours: CIE L*a*b* under D50, 2 degrees, of the chart's maker (ColorChecker Classic, charts made after
// November 2014). sRGB is D65: adapted by Bradford's matrix (ICC.1:2022, annex E). Colour difference: CIEDE2000 (Sharma,
// Wu, Dalal 2005).
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "calibration/gate.h"

namespace calibration {

struct ChartPatch {
  std::string name;
  Eigen::Vector3d lab_d50;
};

// From the brown patch along rows to the black one.
const std::array<ChartPatch, 24>& colour_chart();

Eigen::Vector3d linear_srgb_of_lab(const Eigen::Vector3d& lab_d50);
Eigen::Vector3d lab_of_linear_srgb(const Eigen::Vector3d& linear_srgb);  // below 0: outside of sRGB
double delta_e_2000(const Eigen::Vector3d& lab, const Eigen::Vector3d& other_lab);

struct ColourFit {
  Eigen::Matrix3d linear_srgb_from_camera = Eigen::Matrix3d::Identity();
  std::vector<double> delta_e;  // CIEDE2000 of each patch
  double mean_delta_e = 0.0, largest_delta_e = 0.0;
  std::vector<Gate> gates;
};

// `camera`: one linear RGB per patch in the chart's order, each channel divided by that of a perfect diffuser in the same
// place and light, so that grey is grey. The matrix makes the sum of squared Lab differences least and keeps white
// (rows sum to 1). Throws std::runtime_error when patches are missing or not finite, or their colours cannot be this
// chart's (held upside down or another chart).
ColourFit fit_colours(const std::vector<Eigen::Vector3d>& camera);

}  // namespace calibration
