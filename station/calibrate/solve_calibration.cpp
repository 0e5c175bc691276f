#include "station/calibrate/solve_calibration.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "calibration/pose.h"
#include "station/calibrate/light_patches.h"
#include "station/documents/gate_list.h"
#include "station/documents/lens_file.h"
#include "station/views.h"

namespace station {
namespace {

constexpr double kDegPerRad = 180.0 / M_PI;

struct Loaded {
  CalibrationPicture picture;
  calibration::SensorPicture raw;
  calibration::TagObservation tags;
};

std::vector<Loaded> load(const std::filesystem::path& folder, const std::vector<CalibrationPicture>& pictures,
                         const StepProgress& progress) {
  std::vector<Loaded> loaded;
  for (const CalibrationPicture& picture : pictures) {
    progress(static_cast<int>(loaded.size()), static_cast<int>(pictures.size()), "tags in " + picture.id);
    Loaded entry{.picture = picture, .raw = calibration::read_sensor_file(folder / picture.file), .tags = {}};
    entry.tags = tags_in(entry.raw);
    loaded.push_back(std::move(entry));
  }
  return loaded;
}

// From the camera to the middle of what stands on the platform, by tape; the board is held near it too.
double working_distance_mm(const RigFile& rig) {
  return (Eigen::Vector3d(0, 0, rig.platform_height_mm + 34) - rig.world_from_camera_by_tape.translation()).norm();
}

calibration::LightFit solve_light(const RigFile& rig, const calibration::Lens& lens,
                                  const Eigen::Isometry3d& world_from_camera, const std::vector<Loaded>& loaded) {
  std::vector<calibration::LightPatch> patches;
  for (const Loaded& entry : loaded) {
    const bool front = entry.picture.role == CalibrationRole::front_light;
    if (!front && entry.picture.role != CalibrationRole::back_light) continue;
    const auto pose = calibration::fit_pose(lens, rig.spectralon.tags, entry.tags);
    if (!pose) continue;  // a panel without a seen tag says nothing; the fit refuses when too few are left
    const auto cells =
        panel_patches(entry.raw, lens, world_from_camera, pose->camera_from_object, rig.spectralon, front ? 0 : 1);
    patches.insert(patches.end(), cells.begin(), cells.end());
  }
  return calibration::fit_light(patches, {rig.front_lamp_mm, rig.back_lamp_mm}, rig.spectralon.albedo,
                                cv::Size(lens.width_px, lens.height_px));
}

}  // namespace

RigCalibration solve_calibration(const RigFile& rig, const std::filesystem::path& folder,
                                 const std::vector<CalibrationPicture>& pictures, const StepProgress& progress) {
  const std::vector<Loaded> loaded = load(folder, pictures, progress);
  if (loaded.empty())
    throw std::runtime_error("no calibration pictures in " + folder.string() + "; run calibrate with the rig first");
  std::vector<calibration::TagObservation> lens_views, flat_views;
  std::vector<calibration::PlatformView> turning;
  RigCalibration result;
  for (const Loaded& entry : loaded) {
    result.picture_sha256.push_back(entry.picture.sha256);
    if (entry.picture.role == CalibrationRole::lens) lens_views.push_back(entry.tags);
    if (entry.picture.role == CalibrationRole::flat) flat_views.push_back(entry.tags);
    if (entry.picture.role == CalibrationRole::turning)
      turning.push_back({.reading_rad = entry.picture.reading_rad, .seen = entry.tags});
  }
  const cv::Size size = loaded.front().raw.mosaic.size();
  result.rig_name = rig.name;
  result.spectralon_albedo = rig.spectralon.albedo;
  result.linear_srgb_from_camera = rig.linear_srgb_from_camera;
  const double distance_mm = working_distance_mm(rig);
  result.lens = calibration::fit_lens(lens_views, rig.board, size, rig.focal_length_guess_px,
                                      {.working_distance_mm = distance_mm, .taped_distance_mm = distance_mm});
  refuse_failed_gates(result.lens.gates, "the lens calibration");
  result.platform = calibration::fit_platform(result.lens.lens, rig.board, turning, flat_views,
                                              rig.platform_height_mm + rig.board_thickness_mm);
  result.light = solve_light(rig, result.lens.lens, result.platform.world_from_camera, loaded);
  if (!result.lens.converged || !result.platform.converged || !result.light.converged)
    throw std::runtime_error(std::string("the calibration did not converge (") +
                             (result.lens.converged ? "" : "lens ") + (result.platform.converged ? "" : "platform ") +
                             (result.light.converged ? "" : "light ") +
                             "); take its pictures again with calibrate --only");
  progress(static_cast<int>(pictures.size()), static_cast<int>(pictures.size()), "solved");
  return result;
}

std::string describe(const RigCalibration& calibration) {
  const Eigen::Vector3d camera = calibration.platform.world_from_camera.translation();
  const auto sigma_mm = [&](std::size_t i) {
    return std::sqrt(calibration.light.position_covariances.at(i).trace());
  };
  char text[900];
  std::snprintf(text, sizeof text,
                "platform  camera at %.1f, %.1f, %.1f mm; angle scale %.5f; angles rms %.4f deg; rms %.3f px\n"
                "light     front %.1f, %.1f, %.1f mm (+-%.1f), back %.1f, %.1f, %.1f mm (+-%.1f), rms %.2f %%\n",
                camera.x(), camera.y(), camera.z(), calibration.platform.scale,
                calibration.platform.angle_rms_rad * kDegPerRad, calibration.platform.rms_px,
                calibration.light.positions[0].x(), calibration.light.positions[0].y(),
                calibration.light.positions[0].z(), sigma_mm(0), calibration.light.positions[1].x(),
                calibration.light.positions[1].y(), calibration.light.positions[1].z(), sigma_mm(1),
                100 * calibration.light.relative_rms);
  return describe(calibration.lens) + text;
}

}  // namespace station
