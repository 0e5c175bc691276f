// Mean and variance, pixel by pixel, of raw pictures of one scene at one exposure; the pictures are not kept.
#pragma once

#include "calibration/sensor/sensor_file.h"

namespace calibration {

class PictureStack {
 public:
  // Throws std::runtime_error when size, exposure or ISO differ from the first picture's.
  void add(const SensorPicture& picture);

  int count() const { return count_; }
  double exposure_s() const { return exposure_s_; }
  int iso() const { return iso_; }
  cv::Mat1f mean_dn() const;       // throws when there is no picture
  cv::Mat1f variance_dn2() const;  // the variance of a single picture; throws when there are fewer than two

 private:
  int count_ = 0, iso_ = 0;
  double exposure_s_ = 0.0;
  cv::Mat1f first_, sum_, squares_;  // sums of the differences from the first picture, small enough for float
};

}  // namespace calibration
