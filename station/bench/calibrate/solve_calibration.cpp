#include "station/bench/calibrate/solve_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "calibration/geometry/pose.h"
#include "station/bench/calibrate/chart_squares.h"
#include "station/bench/calibrate/lamp_monitor.h"
#include "station/bench/calibrate/lamps.h"
#include "station/bench/calibrate/panel_spots.h"
#include "station/bench/calibrate/solve_response.h"
#include "station/bench/camera_adapter.h"
#include "station/documents/degree.h"
#include "station/documents/lens_file.h"

namespace station {
namespace {

struct Loaded {
  CalibrationPicture picture;
  calibration::SensorPicture raw;
  calibration::TagObservation tags;
};

std::vector<Loaded> load(const std::filesystem::path& folder, const std::vector<CalibrationPicture>& pictures,
                         const StepProgress& progress) {
  std::vector<Loaded> loaded;
  for (const CalibrationPicture& picture : pictures) {
    if (is_sensor_role(picture.role)) continue;
    progress(static_cast<int>(loaded.size()), static_cast<int>(pictures.size()), "tags in " + picture.id);
    Loaded entry{.picture = picture, .raw = calibration::read_sensor_file(folder / picture.file), .tags = {}};
    entry.tags = tags_in(entry.raw);
    loaded.push_back(std::move(entry));
  }
  return loaded;
}

// All pictures must come from one body at one aperture.
CameraSetup camera_of_pictures(const RigFile& rig, const std::vector<Loaded>& loaded) {
  const calibration::SensorPicture& first = loaded.front().raw;
  for (const Loaded& entry : loaded) {
    const calibration::SensorPicture& raw = entry.raw;
    if (raw.model == first.model && raw.serial == first.serial && raw.f_number == first.f_number &&
        raw.mosaic.size() == first.mosaic.size())
      continue;
    throw std::runtime_error("calibration picture " + entry.picture.id + " was taken with camera " + raw.model + " " +
                             raw.serial + " at f/" + std::to_string(raw.f_number) + ", the first one with " +
                             first.model + " " + first.serial + " at f/" + std::to_string(first.f_number) +
                             "; take all of them again with one camera and aperture");
  }
  return {.model = first.model,
          .serial = first.serial,
          .lens = rig.lens_name,
          .focus = rig.focus,
          .f_number = f_number_of(first)};
}

// The relative error of an output told by the table's tags: they are grey paper, and light comes by way of other
// things.
constexpr double kTagsSigma = 0.0015;

calibration::LightFit solve_light(const RigFile& rig, const calibration::Lens& lens,
                                  const Eigen::Isometry3d& world_from_camera, const std::vector<Loaded>& loaded,
                                  const calibration::StillTags& still, const calibration::SensorResponse* response) {
  std::vector<calibration::PanelSpot> spots;
  std::vector<calibration::LightPicture> pictures;
  std::array<std::vector<std::size_t>, 2> under;  // pictures under the lamp in front, behind
  std::array<std::vector<std::map<int, double>>, 2> tags;
  for (const Loaded& entry : loaded) {
    const bool front = entry.picture.role == CalibrationRole::front_light;
    if (!front && entry.picture.role != CalibrationRole::back_light) continue;
    const auto pose = calibration::fit_pose(lens, rig.spectralon.tags, entry.tags);
    if (!pose)
      throw std::runtime_error(entry.picture.id +
                               " is dark or does not show the panel: none of its tags was found; switch the lamp on, "
                               "hold the panel into the picture and take it again with calibrate --only light");
    const calibration::Developed picture = calibration::develop(entry.raw, {.response = response});
    const auto seen = panel_spots(picture, lens, world_from_camera, pose->camera_from_object, rig.spectralon,
                                  front ? 0 : 1, static_cast<int>(pictures.size()));
    spots.insert(spots.end(), seen.begin(), seen.end());
    under.at(front ? 0 : 1).push_back(pictures.size());
    tags.at(front ? 0 : 1).push_back(tag_radiances(picture, still));
    pictures.push_back({.name = entry.picture.id, .output = entry.picture.lamp_output});
  }
  for (const std::size_t place : {0, 1}) {
    const std::vector<std::optional<double>> outputs = lamp_outputs(tags.at(place));
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      calibration::LightPicture& picture = pictures.at(under.at(place).at(i));
      if (picture.output || !outputs.at(i)) continue;
      picture.output = outputs.at(i);
      picture.output_sigma = kTagsSigma;
    }
  }
  return calibration::fit_light(spots, lamp_guesses(rig), light_options(rig, {lens.width_px, lens.height_px}),
                                pictures);
}

// std::nullopt when no picture of the chart was taken.
std::optional<calibration::ColourFit> solve_colour(const RigFile& rig, const RigCalibration& calibration,
                                                   const std::vector<Loaded>& loaded) {
  for (const Loaded& entry : loaded) {
    if (entry.picture.role != CalibrationRole::colour || !rig.colour_chart) continue;
    const auto pose = calibration::fit_pose(calibration.lens.lens, rig.colour_chart->tags, entry.tags);
    if (!pose)
      throw std::runtime_error(entry.picture.id +
                               " does not show the colour chart: none of its tags was found; hold it "
                               "into the picture and take it again with calibrate --only response");
    calibration::DevelopOptions options{.vignetting = calibration.light.vignetting};
    if (calibration.sensor) options.response = &calibration.sensor->response;
    return calibration::fit_colours(chart_colours(calibration::develop(entry.raw, options), calibration.lens.lens,
                                                  calibration.platform.world_from_camera, pose->camera_from_object,
                                                  *rig.colour_chart, calibration.light));
  }
  return std::nullopt;
}

}  // namespace

RigCalibration solve_calibration(const RigFile& rig, const std::filesystem::path& folder,
                                 const std::vector<CalibrationPicture>& pictures, const StepProgress& progress) {
  const std::vector<Loaded> loaded = load(folder, pictures, progress);
  if (loaded.empty())
    throw std::runtime_error("no calibration pictures in " + folder.string() + "; run calibrate with the rig first");
  std::vector<calibration::TagObservation> lens_views, still_views;
  std::vector<calibration::PlatformPicture> turning;
  RigCalibration result;
  for (const CalibrationPicture& picture : pictures) result.picture_sha256.push_back(picture.sha256);
  for (const Loaded& entry : loaded) {
    if (entry.picture.role == CalibrationRole::lens) lens_views.push_back(entry.tags);
    if (entry.picture.role != CalibrationRole::turning) continue;
    turning.push_back({.reading_rad = entry.picture.reading_rad, .seen = entry.tags});
    still_views.push_back(entry.tags);
  }
  result.camera = camera_of_pictures(rig, loaded);
  const cv::Size size = loaded.front().raw.mosaic.size();
  result.rig_name = rig.name;
  result.spectralon_albedo = rig.spectralon.albedo;
  result.linear_srgb_from_camera = rig.linear_srgb_from_camera;
  const double distance_mm = working_distance_mm(rig);
  result.lens = calibration::fit_lens(lens_views, rig.board, size, rig.focal_length_guess_px,
                                      {.working_distance_mm = distance_mm, .taped_distance_mm = distance_mm});
  result.platform =
      calibration::fit_platform(result.lens.lens, {.ring = rig.platform_ring, .table = rig.table_tags}, turning);
  result.still_tags = calibration::still_tags(rig.table_tags, still_views);
  auto read = static_cast<int>(loaded.size());
  const auto total = static_cast<int>(pictures.size());
  result.sensor = solve_response(folder, pictures,
                                 [&](const std::string& label) { progress(std::min(read++, total), total, label); });
  result.light = solve_light(rig, result.lens.lens, result.platform.world_from_camera, loaded, result.still_tags,
                             &result.sensor->response);
  if (!result.lens.converged || !result.platform.converged || !result.light.converged)
    throw std::runtime_error(std::string("the calibration did not converge (") +
                             (result.lens.converged ? "" : "lens ") + (result.platform.converged ? "" : "platform ") +
                             (result.light.converged ? "" : "light ") +
                             "); take its pictures again with calibrate --only");
  result.colour = solve_colour(rig, result, loaded);
  if (result.colour)
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(result.linear_srgb_from_camera.data()) =
        result.colour->linear_srgb_from_camera;
  progress(static_cast<int>(pictures.size()), static_cast<int>(pictures.size()), "solved");
  return result;
}

std::string describe(const RigCalibration& calibration) {
  const Eigen::Vector3d camera = calibration.platform.world_from_camera.translation();
  const calibration::LightFit& light = calibration.light;
  char text[1200];
  std::snprintf(text, sizeof text,
                "platform  camera at %.1f, %.1f, %.1f mm; angle scale %.5f; angles rms %.4f deg; rms %.3f px\n",
                camera.x(), camera.y(), camera.z(), calibration.platform.scale,
                calibration.platform.angle_rms_rad / kDegree, calibration.platform.rms_px);
  std::string lines = describe(calibration.lens) + text;
  for (std::size_t i = 0; i < light.positions.size(); ++i) {
    const Eigen::Vector3d& at = light.positions[i];
    std::snprintf(text, sizeof text,
                  "light     %s at %.1f, %.1f, %.1f mm (+-%.1f), irradiance at the platform +-%.2f %%, pictures held "
                  "out %.2f %%\n",
                  i == 0 ? "front" : "back ", at.x(), at.y(), at.z(),
                  std::sqrt(light.position_covariances.at(i).trace()), 100 * light.aim_irradiance_sigma.at(i),
                  100 * held_out_error(light, static_cast<int>(i)));
    lines += text;
  }
  std::snprintf(text, sizeof text, "          beam cos^%.2f, panel's droop %.1f %% at 60 deg, spots rms %.2f %%\n",
                light.beam_exponent, 100 * light.droop.sum(), 100 * light.relative_rms);
  lines += text;
  if (calibration.colour) {
    std::snprintf(text, sizeof text, "colour    chart to CIEDE2000 %.2f in the mean, %.2f at most\n",
                  calibration.colour->mean_delta_e, calibration.colour->largest_delta_e);
    lines += text;
  }
  return lines + (calibration.sensor ? describe(*calibration.sensor) : std::string());
}

}  // namespace station
