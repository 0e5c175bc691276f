// The developed views of a session (linear/views.json, kind "views"): everything that the inversion needs, in the
// holder's frame.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "inversion/view/view.h"
#include "rig/people/operator.h"

namespace station {

struct DevelopedView {
  inversion::View view;  // its image and mask are empty before read_view_pictures
  rig::Mounting mounting = rig::Mounting::horizontal;
  double platform_angle_rad = 0.0;
  bool angle_measured = false;  // by the ring's tags in this picture; else by the turntable, calibrated
  double exposure_s = 0.0;
  std::string image_file, mask_file;  // relative to the session folder
  int masked_pixels = 0;
  double saturated_fraction = 0.0;  // share of the masked pixels
  double pose_rms_px = 0.0;         // residual of the holder's tags at this mounting
  double lamp_strength = 1.0;       // the lamp's, relative to the first view, by the reference chip
  // The noise of the picture as it is on the disk, before the division by lamp_strength; absent without a calibrated
  // sensor.
  std::optional<inversion::NoiseLaw> noise{};
};

struct DevelopedViews {
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major; for display only
  std::optional<double> sheet_width_mm;  // turns x thread diameter, measured in the pictures
  std::vector<DevelopedView> views;
};

// Write and read the document, without the pictures. Errors: those of reader.h.
nlohmann::json to_json(const DevelopedViews& views);
DevelopedViews parse_views(const nlohmann::json& document, const std::string& source);
DevelopedViews read_views(const std::filesystem::path& session);
// Reads each view's image and mask. The images, and the law of their noise, are divided by the views' lamp strengths.
// Errors: std::runtime_error for a picture that is missing or has not the size of its view's camera.
void read_view_pictures(const std::filesystem::path& session, DevelopedViews& views);

}  // namespace station
