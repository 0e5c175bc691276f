// The small grey diffuser on the holder that is seen in every view: how bright the lamp is now.
//
// Two chips, each lying on an edge of the frame that is up in one mounting, reaching backwards from the front face: lit like
// the threads from the front and from behind, and turning with the platform about its own normal, so that what its surface
// is, which is the Spectralon panel's kind, stays the same from view to view. Seen and lit at 50 to 60 degrees it is some 10 %
// off a Lambertian surface: darker under the lamp in front, brighter under the one behind.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "inversion/view.h"
#include "rig/operator.h"

namespace station {

struct ReferencePatch {
  double edge_mm = 8;
  double albedo = 0.4;  // grey: white would saturate beside dark threads
};

// Centre of the chip that is up in this mounting, +z its normal; holder frame, mm.
Eigen::Isometry3d holder_from_patch(const ReferencePatch& patch, const inversion::WrappedSpool& spool,
                                    rig::Mounting mounting);

// Corners of what is read of that chip, away from its border, in the picture of `camera` (holder frame), pixels; they may lie
// outside of it.
std::array<Eigen::Vector2d, 4> patch_outline(const renderer::Camera& camera, const ReferencePatch& patch,
                                             const inversion::WrappedSpool& spool, rig::Mounting mounting);

struct PatchReading {
  double strength = 0.0;  // measured / expected of the calibrated lamp
  double sigma = 0.0;     // its standard error, of noise alone
};

// `radiance` and `camera` belong together (both with or both without distortion); everything in the holder frame. Nothing
// when the chip is out of the picture, saturated, or fewer than 30 pixels. `droop`: the panel's, as calibrated
// (calibration/light.h).
std::optional<PatchReading> read_patch(const cv::Mat3f& radiance, const cv::Mat1b& saturated,
                                       const renderer::Camera& camera, const ReferencePatch& patch,
                                       const inversion::WrappedSpool& spool, rig::Mounting mounting,
                                       const inversion::NearLight& light, const Eigen::Vector2d& droop);

// Strength of the lamp in a series of views relative to the first (1), from their readings. Readings under the lamp in front
// and behind have factors of their own (position and surface are not known as well as a reading repeats): a series behind
// stands, in the mean, on the straight line in time between what is read in front before and after it. Views without a reading get their
// predecessor's strength.
struct PatchView {
  bool behind = false;
  double time_s = 0.0;  // of the picture, from any beginning
  std::optional<PatchReading> reading;
};
std::vector<double> lamp_strengths(const std::vector<PatchView>& views);

}  // namespace station
