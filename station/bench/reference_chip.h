// The reference chip: a small grey diffuser on the holder that is seen in every view and tells how bright the lamp is.
//
// There are two chips, one on each edge of the frame that is up in one of the mountings. A chip reaches backwards from
// the front face, so it is lit like the threads from the front and from behind. It turns with the platform about its
// own normal, so its surface, which is of the Spectralon panel's kind, answers alike from view to view. Seen and lit at
// 50 to 60 degrees it is some 10 % off a Lambertian surface: darker under the lamp in front, brighter under the one
// behind.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "inversion/view/view.h"
#include "rig/people/operator.h"
#include "station/documents/rig_file.h"

namespace station {

// The pose of the chip that is up in this mounting, in the holder's frame (mm): origin in its centre, +z its normal.
Eigen::Isometry3d holder_from_chip(const ReferenceChip& chip, const inversion::WrappedSpool& spool,
                                   rig::Mounting mounting);

// The corners, in pixels, of the part of that chip that is read, away from its border. `camera` is in the holder's
// frame; corners may lie outside of its picture.
std::array<Eigen::Vector2d, 4> chip_outline(const renderer::Camera& camera, const ReferenceChip& chip,
                                            const inversion::WrappedSpool& spool, rig::Mounting mounting);

struct ChipReading {
  double strength = 0.0;  // measured / expected of the calibrated lamp
  double sigma = 0.0;     // its standard error, of noise alone
};

// Reads the chip in a picture; nothing when it is out of the picture, saturated, or fewer than 30 pixels. `radiance`
// and `camera` belong together (both with or both without distortion), and everything is in the holder's frame. `droop`
// is the panel's, as calibrated (calibration/light/light.h).
std::optional<ChipReading> read_chip(const cv::Mat3f& radiance, const cv::Mat1b& saturated,
                                     const renderer::Camera& camera, const ReferenceChip& chip,
                                     const inversion::WrappedSpool& spool, rig::Mounting mounting,
                                     const inversion::NearLight& light, const Eigen::Vector2d& droop);

struct ChipView {
  bool behind = false;
  double time_s = 0.0;  // of the picture, from any beginning
  std::optional<ChipReading> reading;
};
// The strength of the lamp in each of a series of views relative to the first (1), from their readings. Readings under
// the lamp in front and behind differ by a factor, because position and surface are not known as well as a reading
// repeats; it is chosen so that a series behind lies, in the mean, on the straight line in time between the readings in
// front before and after it. A view without a reading gets its predecessor's strength.
std::vector<double> lamp_strengths(const std::vector<ChipView>& views);

}  // namespace station
