// A reader of raw files by LibRaw: what an independent program makes of the bytes that the rig writes.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

struct ReadRaw {
  cv::Mat1w mosaic;
  std::string make, model, serial, filters;  // filters: the colours of the first 2 x 2 pixels, row by row
  double black_dn = 0, maximum_dn = 0, exposure_s = 0, iso = 0, f_number = 0;
  long unix_s = 0;  // LibRaw takes the file's date for local time
};

ReadRaw read_raw(const std::vector<std::byte>& bytes);
