#include "calibration/sensor/picture_stack.h"

#include <cmath>
#include <stdexcept>

#include "calibration/sensor/size_text.h"

namespace calibration {
namespace {}  // namespace

void PictureStack::add(const SensorPicture& picture) {
  if (count_ == 0) {
    picture.mosaic.convertTo(first_, CV_32F);
    sum_ = cv::Mat1f(first_.size(), 0.0F);
    squares_ = sum_.clone();
    exposure_s_ = picture.exposure_s;
    iso_ = picture.iso;
  }
  if (picture.mosaic.size() != first_.size()) {
    throw std::runtime_error("mean of pictures: sizes differ (" + size_text(first_.size()) + " and " +
                             size_text(picture.mosaic.size()) + " px): use pictures of one camera");
  }
  if (std::abs(picture.exposure_s - exposure_s_) > 1e-3 * exposure_s_ || picture.iso != iso_) {
    throw std::runtime_error("mean of pictures: exposures differ (" + std::to_string(exposure_s_) + " s at ISO " +
                             std::to_string(iso_) + ", " + std::to_string(picture.exposure_s) + " s at ISO " +
                             std::to_string(picture.iso) + "): average pictures of one exposure only");
  }
  cv::Mat1f difference;
  picture.mosaic.convertTo(difference, CV_32F);
  difference -= first_;
  sum_ += difference;
  squares_ += difference.mul(difference);
  ++count_;
}

cv::Mat1f PictureStack::mean_dn() const {
  if (count_ == 0) throw std::runtime_error("mean of pictures: none was given: take at least one");
  return cv::Mat1f(first_ + sum_ / count_);
}

cv::Mat1f PictureStack::variance_dn2() const {
  if (count_ < 2) throw std::runtime_error("variance of pictures: fewer than two were given: take more");
  return cv::Mat1f(squares_ / (count_ - 1) - sum_.mul(sum_) / (static_cast<double>(count_) * (count_ - 1)));
}

}  // namespace calibration
