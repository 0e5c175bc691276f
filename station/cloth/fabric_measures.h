// What photographs of a cloth round the black cylinder tell of its weave: how large its repeat is.
//
// Each pixel inside a mask lies somewhere on the crowns of the cloth: its ray meets their cylinder. Brightness there,
// less what changes slowly, is a sum of waves whose frequencies are k / period around the cylinder and l / period along
// it. A wave that stands out of the noise beside it has its frequency to within sqrt(1.5 / SNR) / (pi extent), the
// Cramer-Rao bound, widened by the window; both periods follow from all waves by least squares.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "renderer/picture/camera.h"

namespace station {

struct MeasuredValue {
  double value = 0, sigma = 0;  // standard error
};

struct PhotographedCloth {
  cv::Mat3f image;
  cv::Mat1b mask;
  renderer::Camera camera;  // in the cylinder's frame (cloth_on_cylinder.h)
};

struct ClothPeriods {
  std::optional<MeasuredValue> around_mm, along_mm;  // nothing: no wave of it stands out
  int waves = 0;                                     // in all pictures
};

struct PeriodSearch {
  double crown_radius_mm = 41, middle_radius_mm = 41;  // of the crowns, and of the cloth whose lengths are meant
  double around_mm = 1, along_mm = 1;                  // the repeat that is expected
  double within = 0.15;                                // how far from it, as a share, is looked
  // How far the cylinder may stand from where it is taken to stand, and the camera from it: a share of all lengths.
  double scale_sigma = 0.002;
};

// The repeat of the cloth in all pictures.
ClothPeriods measure_periods(const std::vector<PhotographedCloth>& pictures, const PeriodSearch& search);

}  // namespace station
