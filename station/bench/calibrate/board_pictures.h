// The pictures of a printed board in a folder, by whatever camera: JPEG, PNG, TIFF or raw.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "renderer/picture/taken_with.h"

namespace station {

// The folder's pictures, sorted by name. Throws std::runtime_error when there is no folder or no picture in it.
std::vector<std::filesystem::path> board_pictures_in(const std::filesystem::path& folder);

struct GreyPicture {
  cv::Mat1f linear;
  cv::Mat1b display;  // 8 bits, for people and for chessboards
};

// Throws std::runtime_error that names the file when it is no picture or breaks off before its end.
GreyPicture read_grey_picture(const std::filesystem::path& file);

// How the second picture cannot be of the same calibrated lens as the first, as "was taken by A, the first by B"; empty
// when nothing speaks against it.
std::string other_lens(const renderer::TakenWith& first, const renderer::TakenWith& second);

}  // namespace station
