// What pictures in cloth share: the picture brought to crossings, and its colours.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core.hpp>

namespace station {

inline constexpr double kMostPictureCrossings = 16e6;

// Of a picture in a file (renderer::read_linear_srgb) times `exposure`: a pixel for each crossing, `ends` (0: as many as it has pixels)
// across and as many picks as keep its shape. Errors: those of read_linear_srgb; more than `most` crossings.
cv::Mat3f picture_of_crossings(const std::filesystem::path& image, int ends, double exposure,
                               const Eigen::Vector2d& crossing_mm, double most = kMostPictureCrossings);

Eigen::Vector3d lab_of(const cv::Vec3f& linear_srgb);
// Of two pictures in linear sRGB, pixel by pixel.
cv::Mat1f colour_errors(const cv::Mat3f& a, const cv::Mat3f& b);

// Enlarged or reduced to the width of a panel of a sheet; crossings are so many times as high as wide.
cv::Mat3b panel_of(const cv::Mat3b& picture, double crossing_height);

}  // namespace station
