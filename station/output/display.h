// Linear pictures made ready for people: exposure, crop round the threads, mask outline.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>

namespace station {

// The scale that brings the 99th percentile of the masked pixels' brightest channel to just below white. Without a mask
// all pixels count.
double display_scale(const cv::Mat3f& linear, const cv::Mat1b& mask = {});

// The mask's bounding box, grown by `margin_px` and then to the picture's own aspect ratio, inside the picture; the
// whole picture when the mask is empty.
cv::Rect threads_box(const cv::Mat1b& mask, int margin_px = 24);

// How a picture is exposed: `white` (camera RGB, above 0), which a white card has in the same light, is the screen's
// white, and each stop shows everything twice as bright. Pictures that are to be compared have one exposure.
struct Exposure {
  std::array<double, 3> white{1, 1, 1};
  int stops = 0;
};

// The most stops at which the 99th percentile that display_scale looks for is still below white.
int fitting_stops(const cv::Mat3f& linear, const std::array<double, 3>& white, const cv::Mat1b& mask = {});
// "a white card is white", or "a white card is white, then 2 stops darker".
std::string describe(const Exposure& exposure);

// The picture as a screen shows it, in sRGB.
cv::Mat3b display(const cv::Mat3f& linear, const Exposure& exposure,
                  const std::array<double, 9>& linear_srgb_from_camera);
// The same after multiplication by `scale`.
cv::Mat3b display(const cv::Mat3f& linear, double scale, const std::array<double, 9>& linear_srgb_from_camera);
// The same at the display_scale of all pixels.
cv::Mat3b display(const cv::Mat3f& linear, const std::array<double, 9>& linear_srgb_from_camera);

// Draws the mask's outline, one pixel wide.
void draw_outline(cv::Mat3b& picture, const cv::Mat1b& mask);

}  // namespace station
