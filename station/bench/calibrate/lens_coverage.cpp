#include "station/bench/calibrate/lens_coverage.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calibration/geometry/lens_fit.h"
#include "calibration/geometry/pose.h"
#include "station/bench/calibrate/lamps.h"
#include "station/bench/calibrate/standing_target.h"
#include "station/documents/degree.h"
#include "station/documents/number_text.h"

namespace station {
namespace {

constexpr double kLeast_rad = 12 * kDegree;  // that counts as leaning
constexpr double kUnseenLight = 0.45;        // of what the live view shows there

}  // namespace

void LensCoverage::add(const calibration::TagObservation& seen, cv::Size size) {
  const calibration::TagLayout& tags = target_tags(rig_, rig::BenchObject::board);
  const auto fit = calibration::fit_pose(engraved_lens(rig_, size), tags, seen);
  if (!fit) return;
  ++pictures_;
  views_.push_back(seen);
  size_ = size;
  for (const calibration::TagDetection& tag : seen) {
    if (std::ranges::find(tags.tags, tag.id, &calibration::Tag::id) == tags.tags.end()) continue;
    for (const Eigen::Vector2d& corner : tag.corners_px) {
      const int column = static_cast<int>(corner.x() * kColumns / size.width),
                row = static_cast<int>(corner.y() * kRows / size.height);
      seen_.at(static_cast<std::size_t>(std::clamp(row, 0, kRows - 1) * kColumns +
                                        std::clamp(column, 0, kColumns - 1))) = true;
    }
  }
  // The board's face towards the camera, whose frame is x right, y down, z forward.
  Eigen::Vector3d face = fit->camera_from_object.linear().col(2);
  if (face.z() > 0) face = -face;
  const double right_rad = std::atan2(face.x(), -face.z()), down_rad = std::atan2(face.y(), -face.z());
  leans_[kToLeft] |= right_rad < -kLeast_rad;
  leans_[kToRight] |= right_rad > kLeast_rad;
  leans_[kBack] |= down_rad < -kLeast_rad;
  leans_[kForward] |= down_rad > kLeast_rad;
}

double LensCoverage::share() const {
  return static_cast<double>(std::ranges::count(seen_, true)) / static_cast<double>(seen_.size());
}

bool LensCoverage::lens_is_known() {
  sigma_px_.reset();
  try {
    const double distance_mm = working_distance_mm(rig_);
    const calibration::LensFit fit =
        calibration::fit_lens(views_, rig_.board, size_, rig_.focal_length_guess_px,
                              {.working_distance_mm = distance_mm, .taped_distance_mm = distance_mm});
    sigma_px_ = calibration::middle_sigma_px(fit);
    return calibration::is_well_known(fit);
  } catch (const std::runtime_error&) {  // they do not determine a lens
    return false;
  }
}

std::string LensCoverage::sentence() const {
  if (pictures_ == 0) return "";
  constexpr std::array<const char*, kLeans> kNames{"turned to the left", "turned to the right", "tilted back",
                                                   "tilted forward"};
  std::string missing;
  for (std::size_t lean = 0; lean < kNames.size(); ++lean)
    if (!leans_.at(lean)) missing += (missing.empty() ? "" : ", ") + std::string(kNames.at(lean));
  std::string known;
  if (sigma_px_)
    known = " The lens is known to " + number_text(*sigma_px_, 3) + " px, and " +
            number_text(calibration::kWellKnown_px, 2) + " are enough.";
  return "So far the board was seen in " + percent_text(share()) + " of the picture (the rest is darkened)" +
         (missing.empty() ? "." : ", and not yet " + missing + ".") + known;
}

void LensCoverage::shade_unseen(cv::Mat3b& frame) const {
  if (pictures_ == 0) return;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      if (seen_.at(static_cast<std::size_t>(row * kColumns + column))) continue;
      const cv::Point from(column * frame.cols / kColumns, row * frame.rows / kRows),
          to((column + 1) * frame.cols / kColumns, (row + 1) * frame.rows / kRows);
      frame(cv::Rect(from, to)) *= kUnseenLight;
    }
}

}  // namespace station
