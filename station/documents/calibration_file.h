// The rig calibration that sessions use (kind "calibration"): lens, camera pose, platform, sensor, lamp positions and
// intensity.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/lens_fit.h"
#include "calibration/geometry/platform.h"
#include "calibration/geometry/still_tags.h"
#include "calibration/light/colour_chart.h"
#include "calibration/light/light.h"
#include "station/documents/sensor_section.h"

namespace station {

// The camera settings for which a lens calibration holds: another body, lens, focus or aperture makes other pictures.
struct CameraSetup {
  std::string model, serial;  // from the pictures
  std::string lens, focus;    // from the rig file: most lenses report neither
  double f_number = 8.0;      // from the pictures
};

struct RigCalibration {
  CameraSetup camera;
  calibration::LensFit lens;
  calibration::PlatformFit platform;
  calibration::StillTags still_tags;             // the table's tags, as the platform pictures showed them
  calibration::LightFit light;                   // light 0 = front, 1 = back
  std::optional<SensorSection> sensor;           // absent: black level and exposure times are the files'
  std::optional<calibration::ColourFit> colour;  // absent: no chart; linear_srgb_from_camera is the rig file's
  double spectralon_albedo = 0.99;
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major; for display only
  std::string rig_name, utc, software;
  std::vector<std::string> picture_sha256;  // one per picture that it was solved from, in their order
};

// The acceptance checks of all parts of the calibration, part after part.
std::vector<calibration::Gate> all_gates(const RigCalibration& calibration);

nlohmann::json to_json(const RigCalibration& calibration);
RigCalibration parse_calibration(const nlohmann::json& document, const std::string& source);
// The path of a calibration's document: `folder_or_file` itself, or calibration.json in it when it is a folder.
std::filesystem::path calibration_document(const std::filesystem::path& folder_or_file);
RigCalibration read_calibration(const std::filesystem::path& folder_or_file);  // errors: those of reader.h
// Fills in the maps of the calibration's sensor, if it has one, from `folder`. Errors: those of fill_in_sensor_maps.
void fill_in_sensor_maps(const std::filesystem::path& folder, RigCalibration& calibration);

}  // namespace station
