// What the lens pictures of a calibration have shown of the board so far: in which parts of the picture, how it was
// turned and tilted there, and whether that is enough. A lens is known where its board was seen, and its focal length
// by boards that lean.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/tags.h"
#include "station/documents/rig_file.h"

namespace station {

class LensCoverage {
 public:
  static constexpr int kColumns = 12, kRows = 8;  // of the parts of a picture

  explicit LensCoverage(const RigFile& rig) : rig_(rig) {}  // which must outlive it
  // The board's tags in a picture of `size`.
  void add(const calibration::TagObservation& seen, cv::Size size);

  int pictures() const { return pictures_; }
  double share() const;  // of the parts in which a tag was seen, 0 to 1
  // Fits a lens to the pictures so far: whether no more are needed.
  bool lens_is_known();
  // The share so far, the ways of leaning that were not seen yet, and, after lens_is_known, how well the lens is known;
  // empty before the first picture.
  std::string sentence() const;
  // Darkens the parts of a live frame in which no picture has shown the board; nothing before the first picture.
  void shade_unseen(cv::Mat3b& frame) const;

 private:
  enum Lean { kToLeft, kToRight, kBack, kForward, kLeans };

  const RigFile& rig_;
  int pictures_ = 0;
  std::vector<calibration::TagObservation> views_;
  cv::Size size_;
  std::optional<double> sigma_px_;
  std::array<bool, kColumns * kRows> seen_{};
  std::array<bool, kLeans> leans_{};
};

}  // namespace station
