// The reader of raw files (by LibRaw, which is used nowhere else): the untouched mosaic with its levels and exposure.
#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core.hpp>
#include <span>
#include <string>

namespace calibration {

struct SensorPicture {
  cv::Mat1w mosaic;              // DN as recorded, black level not subtracted; margins removed
  std::array<int, 4> channel{};  // colour (0 R, 1 G, 2 B) of the 2 x 2 cell: (0,0) (0,1) (1,0) (1,1) as (row, column)
  double black_level_dn = 0.0, white_level_dn = 0.0;
  double exposure_s = 0.0, f_number = 0.0;
  int iso = 0;
  double focal_length_35mm = 0;  // mm, of a lens with the same field of view on 36 x 24 mm; 0: the file does not say it
  std::string make, model, serial, date_time;
};

// Read a raw file, or the bytes of one. Errors: std::runtime_error naming the file, what LibRaw found and what to do;
// lossy (compressed) Sony files are refused.
SensorPicture read_sensor_file(const std::filesystem::path& file);
SensorPicture read_sensor_bytes(std::span<const std::byte> bytes, const std::string& name_for_errors);

}  // namespace calibration
