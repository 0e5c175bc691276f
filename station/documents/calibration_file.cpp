#include "station/documents/calibration_file.h"

#include <algorithm>

#include "station/documents/degree.h"
#include "station/documents/gate_list.h"
#include "station/documents/lens_file.h"
#include "station/documents/matrix_rows.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using nlohmann::json;

json camera_json(const CameraSetup& camera) {
  return {{"model", camera.model},
          {"serial", camera.serial},
          {"lens", camera.lens},
          {"focus", camera.focus},
          {"f_number", camera.f_number}};
}

CameraSetup parse_calibrated_camera(ObjectReader reader) {
  CameraSetup camera{.model = reader.text("model"),
                     .serial = reader.text("serial"),
                     .lens = reader.text("lens"),
                     .focus = reader.text("focus"),
                     .f_number = reader.number("f_number", 0.5, 100)};
  reader.finish();
  return camera;
}

json degrees_json(const std::vector<double>& angles_rad) {
  json angles = json::array();
  for (const double angle : angles_rad) angles.push_back(angle / kDegree);
  return angles;
}

std::vector<double> read_degrees(ObjectReader& reader, const std::string& key) {
  std::vector<double> angles_rad;
  for (const double angle : reader.numbers(key)) angles_rad.push_back(angle * kDegree);
  return angles_rad;
}

// Each tag becomes [id, x, y, x, y, x, y, x, y].
json still_tags_json(const calibration::StillTags& tags) {
  json list = json::array();
  for (const auto& [id, corners] : tags) {
    json tag = json::array({id});
    for (const Eigen::Vector2d& corner : corners) {
      tag.push_back(corner.x());
      tag.push_back(corner.y());
    }
    list.push_back(tag);
  }
  return list;
}

calibration::StillTags read_still_tags(ObjectReader& reader, const std::string& key) {
  const std::string expected = "expected a list of [id, x, y, x, y, x, y, x, y]";
  const json& list = reader.raw(key);
  if (!list.is_array()) reader.refuse(key, expected);
  calibration::StillTags tags;
  for (const json& tag : list) {
    const bool numbers = tag.is_array() && tag.size() == 9 &&
                         std::all_of(tag.begin(), tag.end(), [](const json& entry) { return entry.is_number(); });
    if (!numbers || !tag[0].is_number_integer()) reader.refuse(key, expected);
    auto& corners = tags[tag[0].get<int>()];
    for (std::size_t c = 0; c < 4; ++c) corners[c] = {tag[2 * c + 1].get<double>(), tag[2 * c + 2].get<double>()};
  }
  return tags;
}

json platform_json(const calibration::PlatformFit& fit, const calibration::StillTags& still) {
  return {{"world_from_camera", to_json(fit.world_from_camera)},
          {"world_from_ring", to_json(fit.world_from_ring)},
          {"world_from_table", to_json(fit.world_from_table)},
          {"angles_deg", degrees_json(fit.angles_rad)},
          {"readings_deg", degrees_json(fit.readings_rad)},
          {"view_rms_px", fit.picture_rms_px},
          {"axis_to_table_normal_deg", fit.axis_to_table_normal_rad / kDegree},
          {"table_tags_px", still_tags_json(still)},
          {"gates", to_json(fit.gates)},
          {"angle_scale", fit.scale},
          {"angle_offset_deg", fit.offset_rad / kDegree},
          {"angle_rms_deg", fit.angle_rms_rad / kDegree},
          {"rms_px", fit.rms_px},
          {"converged", fit.converged},
          {"axis_covariance", matrix_json(fit.axis_covariance)}};
}

calibration::PlatformFit parse_platform(ObjectReader reader, calibration::StillTags& still) {
  calibration::PlatformFit fit;
  fit.world_from_camera = reader.transform("world_from_camera");
  fit.world_from_ring = reader.transform("world_from_ring");
  fit.world_from_table = reader.transform("world_from_table");
  fit.angles_rad = read_degrees(reader, "angles_deg");
  fit.readings_rad = read_degrees(reader, "readings_deg");
  fit.picture_rms_px = reader.numbers("view_rms_px");
  fit.axis_to_table_normal_rad = reader.number("axis_to_table_normal_deg", 0, 180) * kDegree;
  still = read_still_tags(reader, "table_tags_px");
  fit.gates = parse_gates(reader, "gates");
  fit.scale = reader.number("angle_scale", 0.1, 10);
  fit.offset_rad = reader.number("angle_offset_deg", -360, 360) * kDegree;
  fit.angle_rms_rad = reader.number("angle_rms_deg", 0, 360) * kDegree;
  fit.rms_px = reader.number("rms_px", 0, 1e6);
  fit.converged = reader.flag("converged");
  fit.axis_covariance = read_matrix(reader, "axis_covariance", 4, 4);
  reader.finish();
  return fit;
}

json place_json(const calibration::LightFit& fit, std::size_t place) {
  return {{"position_mm", to_json(fit.positions.at(place))},
          {"position_covariance", matrix_json(fit.position_covariances.at(place))},
          {"beam_axis", to_json(fit.beam_axes.at(place))},
          {"aim_irradiance_sigma", fit.aim_irradiance_sigma.at(place)}};
}

void parse_place(ObjectReader reader, calibration::LightFit& fit) {
  fit.positions.push_back(reader.vector3("position_mm"));
  fit.position_covariances.emplace_back(read_matrix(reader, "position_covariance", 3, 3));
  fit.beam_axes.push_back(reader.vector3("beam_axis").normalized());
  fit.aim_irradiance_sigma.push_back(reader.number("aim_irradiance_sigma", 0, 1e6));
  reader.finish();
}

json light_json(const calibration::LightFit& fit, double albedo) {
  json held_out = json::array();
  for (const calibration::HeldOutPicture& held : fit.held_out)
    held_out.push_back({{"picture", held.name},
                        {"light", held.light == 0 ? "front" : "back"},
                        {"output", held.output},
                        {"patch_error", held.spot_error},
                        {"picture_error", held.picture_error}});
  return {{"front", place_json(fit, 0)},
          {"back", place_json(fit, 1)},
          {"intensity_mm2", to_json(fit.intensity)},
          {"intensity_covariance", matrix_json(fit.intensity_covariance)},
          {"beam_exponent", fit.beam_exponent},
          {"beam_exponent_sigma", fit.beam_exponent_sigma},
          {"vignetting", {fit.vignetting.v0, fit.vignetting.v1}},
          {"vignetting_covariance", matrix_json(fit.vignetting_covariance)},
          {"spectralon_albedo", albedo},
          {"spectralon_droop", {fit.droop[0], fit.droop[1]}},
          {"spectralon_droop_sigma", {fit.droop_sigma[0], fit.droop_sigma[1]}},
          {"table_albedo", fit.table_albedo},
          {"relative_rms", fit.relative_rms},
          {"patches_used", fit.spots_used},
          {"held_out", held_out},
          {"gates", to_json(fit.gates)},
          {"converged", fit.converged}};
}

calibration::LightFit parse_light(ObjectReader reader, double& albedo) {
  calibration::LightFit fit;
  parse_place(reader.object("front"), fit);
  parse_place(reader.object("back"), fit);
  fit.intensity = reader.vector3("intensity_mm2");
  fit.intensity_covariance = read_matrix(reader, "intensity_covariance", 3, 3);
  fit.beam_exponent = reader.number("beam_exponent", -10, 1000);
  fit.beam_exponent_sigma = reader.number("beam_exponent_sigma", 0, 1e6);
  const auto vignetting = reader.numbers("vignetting", 2);
  fit.vignetting.v0 = vignetting[0];
  fit.vignetting.v1 = vignetting[1];
  fit.vignetting_covariance = read_matrix(reader, "vignetting_covariance", 2, 2);
  albedo = reader.number("spectralon_albedo", 0.5, 1);
  const auto droop = reader.numbers("spectralon_droop", 2), droop_sigma = reader.numbers("spectralon_droop_sigma", 2);
  fit.droop = {droop[0], droop[1]};
  fit.droop_sigma = {droop_sigma[0], droop_sigma[1]};
  fit.table_albedo = reader.number("table_albedo", -1, 2);
  fit.relative_rms = reader.number("relative_rms", 0, 1e6);
  fit.spots_used = reader.integer("patches_used", 0, 1 << 30);
  for (ObjectReader& entry : reader.objects("held_out")) {
    calibration::HeldOutPicture held{.name = entry.text("picture")};
    held.light = entry.choice("light", {"front", "back"}) == "front" ? 0 : 1;
    held.output = entry.number("output", 0, 1e6);
    held.spot_error = entry.number("patch_error", 0, 1e6);
    held.picture_error = entry.number("picture_error", -1e6, 1e6);
    entry.finish();
    fit.held_out.push_back(held);
  }
  fit.gates = parse_gates(reader, "gates");
  fit.converged = reader.flag("converged");
  reader.finish();
  return fit;
}

calibration::ColourFit parse_colour(ObjectReader reader, const std::array<double, 9>& matrix) {
  calibration::ColourFit fit;
  fit.linear_srgb_from_camera = matrix_of(matrix);
  fit.delta_e = reader.numbers("delta_e_2000");
  fit.mean_delta_e = reader.number("mean_delta_e_2000", 0, 1000);
  fit.largest_delta_e = reader.number("largest_delta_e_2000", 0, 1000);
  fit.gates = parse_gates(reader, "gates");
  reader.finish();
  return fit;
}

}  // namespace

std::vector<calibration::Gate> all_gates(const RigCalibration& calibration) {
  std::vector<calibration::Gate> gates = calibration.lens.gates;
  gates.insert(gates.end(), calibration.platform.gates.begin(), calibration.platform.gates.end());
  gates.insert(gates.end(), calibration.light.gates.begin(), calibration.light.gates.end());
  if (calibration.sensor) gates.insert(gates.end(), calibration.sensor->gates.begin(), calibration.sensor->gates.end());
  if (calibration.colour) gates.insert(gates.end(), calibration.colour->gates.begin(), calibration.colour->gates.end());
  return gates;
}

json to_json(const RigCalibration& calibration) {
  json document = {{"format", "threadstation/calibration"},
                   {"version", 1},
                   {"rig", calibration.rig_name},
                   {"utc", calibration.utc},
                   {"software", calibration.software},
                   {"camera", camera_json(calibration.camera)},
                   {"linear_srgb_from_camera", calibration.linear_srgb_from_camera},
                   {"lens", lens_json(calibration.lens)},
                   {"platform", platform_json(calibration.platform, calibration.still_tags)},
                   {"light", light_json(calibration.light, calibration.spectralon_albedo)},
                   {"picture_sha256", calibration.picture_sha256}};
  if (calibration.sensor) document["sensor"] = to_json(*calibration.sensor);
  if (calibration.colour)
    document["colour"] = {{"delta_e_2000", calibration.colour->delta_e},
                          {"mean_delta_e_2000", calibration.colour->mean_delta_e},
                          {"largest_delta_e_2000", calibration.colour->largest_delta_e},
                          {"gates", to_json(calibration.colour->gates)}};
  return document;
}

RigCalibration parse_calibration(const json& document, const std::string& source) {
  ObjectReader reader(document, source, "calibration");
  RigCalibration calibration;
  calibration.rig_name = reader.text("rig");
  calibration.utc = reader.text("utc");
  calibration.software = reader.text("software");
  calibration.camera = parse_calibrated_camera(reader.object("camera"));
  const auto colour = reader.numbers("linear_srgb_from_camera", 9);
  std::copy(colour.begin(), colour.end(), calibration.linear_srgb_from_camera.begin());
  calibration.lens = parse_lens_fit(reader.object("lens"));
  calibration.platform = parse_platform(reader.object("platform"), calibration.still_tags);
  calibration.light = parse_light(reader.object("light"), calibration.spectralon_albedo);
  if (reader.has("colour"))
    calibration.colour = parse_colour(reader.object("colour"), calibration.linear_srgb_from_camera);
  if (reader.has("sensor")) calibration.sensor = parse_sensor_section(reader.object("sensor"));
  const json& hashes = reader.raw("picture_sha256");
  if (!hashes.is_array()) reader.refuse("picture_sha256", "expected a list of text");
  for (const json& hash : hashes) {
    if (!hash.is_string()) reader.refuse("picture_sha256", "expected a list of text");
    calibration.picture_sha256.push_back(hash.get<std::string>());
  }
  reader.finish();
  return calibration;
}

std::filesystem::path calibration_document(const std::filesystem::path& folder_or_file) {
  return std::filesystem::is_directory(folder_or_file) ? folder_or_file / "calibration.json" : folder_or_file;
}

RigCalibration read_calibration(const std::filesystem::path& folder_or_file) {
  const std::filesystem::path file = calibration_document(folder_or_file);
  return parse_calibration(read_json_file(file), file.string());
}

void fill_in_sensor_maps(const std::filesystem::path& folder, RigCalibration& calibration) {
  const calibration::Lens& lens = calibration.lens.lens;
  if (calibration.sensor) fill_in_sensor_maps(folder, {lens.width_px, lens.height_px}, *calibration.sensor);
}

}  // namespace station
