// A photograph against a rendering of the same view: colour difference, the highlight's profile, and a picture of both.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace station {

// Where a cylinder's highlight is and how wide, from the brightness across the picture, averaged along its columns.
struct HighlightProfile {
  std::vector<double> brightness;  // of each column, relative to the photograph's brightest; 0 outside of the mask
  double peak_px = 0, peak = 0;    // column and value of its maximum, smoothed over 2 % of the width
  double width_px = 0;             // columns above half of that maximum
  double hue_deg = 0;              // CIELAB's, of those columns' light
};

struct Comparison {
  double scale = 1;  // the rendering was multiplied by it: equal means inside the mask
  // The rendering's mean inside the mask over the photograph's, each channel, without that scale; 1 where the
  // photograph is black.
  std::array<double, 3> brightness{1, 1, 1};
  double mean_delta_e = 0, median_delta_e = 0, delta_e_95 = 0;  // CIEDE2000 of block averages
  double relative_rmse = 0;                                     // of the same averages, all channels
  HighlightProfile photograph, rendering;
  double profile_correlation = 0;
  int blocks = 0;
};

struct CompareOptions {
  bool fit_scale = true;  // false: both are in the same unit
  int block_px = 8;       // threads are not where their rendering has them; averages are compared
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

// Compares linear pictures of one size where `mask` is 255, or everywhere when it is empty. White is the photograph's
// 99th percentile inside the mask. Errors: std::runtime_error for other sizes, an empty mask, or pictures without
// light.
Comparison compare_pictures(const cv::Mat3f& photograph, const cv::Mat3f& rendering, const cv::Mat1b& mask,
                            const CompareOptions& options);

// The comparison as a document, with both profiles; colour differences are CIEDE2000.
nlohmann::json to_json(const Comparison& comparison);

// A picture of photograph, rendering (scaled) and their difference (black: none, white: a CIEDE2000 of 20), side by
// side.
cv::Mat3b comparison_picture(const cv::Mat3f& photograph, const cv::Mat3f& rendering, const cv::Mat1b& mask,
                             const CompareOptions& options);

}  // namespace station
