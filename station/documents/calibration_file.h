// The rig calibration that sessions use (kind "calibration"): lens, camera pose, platform, sensor, lamp positions and
// intensity.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/colour_chart.h"
#include "calibration/lens.h"
#include "calibration/light.h"
#include "calibration/platform.h"
#include "calibration/still_tags.h"
#include "station/documents/sensor_section.h"

namespace station {

// What the lens calibration belongs to: another body, lens, focus or aperture makes other pictures.
struct CameraSetup {
  std::string model, serial;  // from the pictures
  std::string lens, focus;    // from the rig file: most lenses say neither
  double f_number = 8.0;      // from the pictures
};

struct RigCalibration {
  CameraSetup camera;
  calibration::LensFit lens;
  calibration::PlatformFit platform;
  calibration::StillTags still_tags;             // of the table, as the platform pictures showed them
  calibration::LightFit light;                   // light 0 = front, 1 = back
  std::optional<SensorSection> sensor;           // absent: black level and exposure times as the files say
  std::optional<calibration::ColourFit> colour;  // absent: no chart, linear_srgb_from_camera is the rig file's
  double spectralon_albedo = 0.99;
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major; for display only
  std::string rig_name, utc, software;
  std::vector<std::string> picture_sha256;  // of the pictures it was solved from, in their order
};

// Of all its parts, in their order.
std::vector<calibration::Gate> all_gates(const RigCalibration& calibration);

nlohmann::json to_json(const RigCalibration& calibration);
RigCalibration parse_calibration(const nlohmann::json& document, const std::string& source);
// `folder_or_file`: a calibration's document, or the folder that holds it as calibration.json.
std::filesystem::path calibration_document(const std::filesystem::path& folder_or_file);
RigCalibration read_calibration(const std::filesystem::path& folder_or_file);

}  // namespace station
