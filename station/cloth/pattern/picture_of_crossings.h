// The picture that a picture in cloth starts from, brought to one pixel per crossing, and its colours.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core.hpp>

namespace station {

inline constexpr double kMostPictureCrossings = 16e6;

// Reads a picture (renderer::read_linear_srgb), multiplies it by `brightness` and brings it to a pixel for each
// crossing: `ends` across (0: as many as it has pixels) and as many picks as keep its shape. Errors: those of
// read_linear_srgb; std::runtime_error for more than `most` crossings.
cv::Mat3f picture_of_crossings(const std::filesystem::path& image, int ends, double brightness,
                               const Eigen::Vector2d& crossing_mm, double most = kMostPictureCrossings);

Eigen::Vector3d lab_of(const cv::Vec3f& linear_srgb);
// The CIEDE2000 between two pictures in linear sRGB, pixel by pixel.
cv::Mat1f colour_errors(const cv::Mat3f& a, const cv::Mat3f& b);

// The picture enlarged or reduced to the width of a panel of a sheet; `crossing_height` is a crossing's height over its
// width.
cv::Mat3b panel_of(const cv::Mat3b& picture, double crossing_height);

}  // namespace station
