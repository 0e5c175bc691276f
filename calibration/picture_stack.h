// Mean and variance of raw pictures of one scene at one exposure, pixel by pixel, without keeping the pictures.
#pragma once

#include "calibration/sensor_file.h"

namespace calibration {

class PictureStack {
 public:
  // Throws std::runtime_error when size, exposure or ISO differ from the first picture's.
  void add(const SensorPicture& picture);

  int count() const { return count_; }
  double exposure_s() const { return exposure_s_; }
  int iso() const { return iso_; }
  cv::Mat1f mean_dn() const;       // throws when there is no picture
  cv::Mat1f variance_dn2() const;  // of one picture; throws when there are fewer than two

 private:
  int count_ = 0, iso_ = 0;
  double exposure_s_ = 0.0;
  cv::Mat1f first_, sum_, squares_;  // sums of what differs from the first: small numbers, so that float is enough
};

}  // namespace calibration
