#include "station/documents/calibration_file.h"

#include <cmath>

#include "station/documents/lens_file.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using nlohmann::json;
constexpr double kRadPerDeg = M_PI / 180.0;

json platform_json(const calibration::PlatformFit& fit) {
  json angles = json::array();
  for (const double angle : fit.angles_rad) angles.push_back(angle / kRadPerDeg);
  return {{"world_from_camera", to_json(fit.world_from_camera)},
          {"angles_deg", angles},
          {"angle_scale", fit.scale},
          {"angle_offset_deg", fit.offset_rad / kRadPerDeg},
          {"angle_rms_deg", fit.angle_rms_rad / kRadPerDeg},
          {"rms_px", fit.rms_px},
          {"converged", fit.converged},
          {"axis_covariance", matrix_json(fit.axis_covariance)}};
}

calibration::PlatformFit parse_platform(ObjectReader reader) {
  calibration::PlatformFit fit;
  fit.world_from_camera = reader.transform("world_from_camera");
  for (const double angle : reader.numbers("angles_deg")) fit.angles_rad.push_back(angle * kRadPerDeg);
  fit.scale = reader.number("angle_scale", 0.1, 10);
  fit.offset_rad = reader.number("angle_offset_deg", -360, 360) * kRadPerDeg;
  fit.angle_rms_rad = reader.number("angle_rms_deg", 0, 360) * kRadPerDeg;
  fit.rms_px = reader.number("rms_px", 0, 1e6);
  fit.converged = reader.flag("converged");
  fit.axis_covariance = read_matrix(reader, "axis_covariance", 4, 4);
  reader.finish();
  return fit;
}

json light_json(const calibration::LightFit& fit, double albedo) {
  return {{"front_position_mm", to_json(fit.positions.at(0))},
          {"back_position_mm", to_json(fit.positions.at(1))},
          {"front_position_covariance", matrix_json(fit.position_covariances.at(0))},
          {"back_position_covariance", matrix_json(fit.position_covariances.at(1))},
          {"intensity_mm2", to_json(fit.intensity)},
          {"intensity_covariance", matrix_json(fit.intensity_covariance)},
          {"vignetting", {fit.vignetting.v0, fit.vignetting.v1}},
          {"spectralon_albedo", albedo},
          {"relative_rms", fit.relative_rms},
          {"converged", fit.converged}};
}

calibration::LightFit parse_light(ObjectReader reader, double& albedo) {
  calibration::LightFit fit;
  fit.positions = {reader.vector3("front_position_mm"), reader.vector3("back_position_mm")};
  fit.position_covariances = {read_matrix(reader, "front_position_covariance", 3, 3),
                              read_matrix(reader, "back_position_covariance", 3, 3)};
  fit.intensity = reader.vector3("intensity_mm2");
  fit.intensity_covariance = read_matrix(reader, "intensity_covariance", 3, 3);
  const auto vignetting = reader.numbers("vignetting", 2);
  fit.vignetting.v0 = vignetting[0];
  fit.vignetting.v1 = vignetting[1];
  albedo = reader.number("spectralon_albedo", 0.5, 1);
  fit.relative_rms = reader.number("relative_rms", 0, 1e6);
  fit.converged = reader.flag("converged");
  reader.finish();
  return fit;
}

}  // namespace

json to_json(const RigCalibration& calibration) {
  return {{"format", "threadstation/calibration"},
          {"version", 1},
          {"rig", calibration.rig_name},
          {"utc", calibration.utc},
          {"software", calibration.software},
          {"linear_srgb_from_camera", calibration.linear_srgb_from_camera},
          {"lens", lens_json(calibration.lens)},
          {"platform", platform_json(calibration.platform)},
          {"light", light_json(calibration.light, calibration.spectralon_albedo)},
          {"picture_sha256", calibration.picture_sha256}};
}

RigCalibration parse_calibration(const json& document, const std::string& source) {
  ObjectReader reader(document, source, "calibration", 1);
  RigCalibration calibration;
  calibration.rig_name = reader.text("rig");
  calibration.utc = reader.text("utc");
  calibration.software = reader.text("software");
  const auto colour = reader.numbers("linear_srgb_from_camera", 9);
  std::copy(colour.begin(), colour.end(), calibration.linear_srgb_from_camera.begin());
  calibration.lens = parse_lens_fit(reader.object("lens"));
  calibration.platform = parse_platform(reader.object("platform"));
  calibration.light = parse_light(reader.object("light"), calibration.spectralon_albedo);
  const json& hashes = reader.raw("picture_sha256");
  if (!hashes.is_array()) reader.refuse("picture_sha256", "expected a list of text");
  for (const json& hash : hashes) {
    if (!hash.is_string()) reader.refuse("picture_sha256", "expected a list of text");
    calibration.picture_sha256.push_back(hash.get<std::string>());
  }
  reader.finish();
  return calibration;
}

RigCalibration read_calibration(const std::filesystem::path& folder_or_file) {
  const bool folder = std::filesystem::is_directory(folder_or_file);
  const std::filesystem::path file = folder ? folder_or_file / "calibration.json" : folder_or_file;
  return parse_calibration(read_json_file(file), file.string());
}

}  // namespace station
