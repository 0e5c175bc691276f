// The developed views of a session (linear/views.json, kind "views"): everything that the inversion needs, holder frame.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "inversion/view.h"
#include "rig/operator.h"

namespace station {

struct DevelopedView {
  inversion::View view;  // image and mask are read on demand (read_view_pictures)
  rig::Mounting mounting = rig::Mounting::horizontal;
  double platform_angle_rad = 0.0;
  bool angle_measured = false;  // from the ring's tags in this picture; else the turntable's reading, calibrated
  double exposure_s = 0.0;
  std::string image_file, mask_file;  // relative to the session folder
  int masked_pixels = 0;
  double saturated_fraction = 0.0;  // of the masked pixels
  double pose_rms_px = 0.0;         // of the holder's tags at this mounting
  double lamp_strength = 1.0;       // relative to the first view, by the reference patch
  // Of the picture as it is on the disk; none without a sensor's calibration.
  std::optional<inversion::NoiseLaw> noise{};
};

struct DevelopedViews {
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major; for display only
  std::optional<double> sheet_width_mm;  // turns x thread diameter as the pictures show it
  std::vector<DevelopedView> views;
};

nlohmann::json to_json(const DevelopedViews& views);
DevelopedViews read_views(const std::filesystem::path& session);
// Divided by their lamp strengths, with the law of their noise.
void read_view_pictures(const std::filesystem::path& session, DevelopedViews& views);

}  // namespace station
