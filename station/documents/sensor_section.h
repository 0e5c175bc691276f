// The section "sensor" of a rig calibration: how the camera's pixels respond to light. Its pixel maps are in two files
// beside calibration.json: sensor_maps.exr (float; R: bias, DN; G: dark current, DN per second; B: flat with dust) and
// sensor_bad_pixels.png (255: bad). A calibration may name none: then every pixel is the median one.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/sensor/gate.h"
#include "calibration/sensor/sensor_maps.h"
#include "calibration/sensor/sensor_response.h"
#include "station/documents/reader.h"

namespace station {

inline constexpr const char* kSensorMapsFile = "sensor_maps.exr";
inline constexpr const char* kBadPixelsFile = "sensor_bad_pixels.png";

struct SensorSection {
  calibration::SensorResponse response;   // its maps are empty before they are filled in
  double bias_dn = 0, dark_dn_per_s = 0;  // medians over the pixels
  double linearity_residual = 0;          // departure from a straight response below 85 % of the range, relative
  calibration::BadPixels bad;
  double dust_depth = 0, flat_noise = 0;  // deepest dust spot of the flat; the flat's standard deviation; relative
  double lamp_flicker = 0;                // from picture to picture, relative standard deviation
  double lamp_drift_per_min = 0, lamp_drift_sigma_per_min = 0;
  std::vector<calibration::Gate> gates;
  std::string maps_sha256, bad_pixels_sha256;  // empty: there are no map files
};

nlohmann::json to_json(const SensorSection& sensor);
SensorSection parse_sensor_section(ObjectReader reader);

// Writes both map files into `folder` and notes their hashes in the section.
void write_sensor_maps(const std::filesystem::path& folder, SensorSection& sensor);
bool has_map_files(const SensorSection& sensor);
// Fills in the maps, for pictures of `size`: both files, or the medians everywhere where there are none. Errors:
// std::runtime_error when a file is missing or differs from its hash.
void fill_in_sensor_maps(const std::filesystem::path& folder, const cv::Size& size, SensorSection& sensor);

}  // namespace station
