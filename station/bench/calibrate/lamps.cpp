#include "station/bench/calibrate/lamps.h"

#include "calibration/geometry/target_stand.h"

namespace station {
namespace {

constexpr double kClear_mm = 2.0;  // above the platform, so that no plate touches it

// The size of the camera's pictures, a real one's as the rig file says.
cv::Size picture_size(const RigFile& rig) {
  if (!rig.simulation) return {rig.camera_wire->setup.width_px, rig.camera_wire->setup.height_px};
  return {rig.simulation->truth.lens.width_px, rig.simulation->truth.lens.height_px};
}

}  // namespace

double working_distance_mm(const RigFile& rig) {
  return (Eigen::Vector3d(0, 0, rig.platform_height_mm + 34) - rig.world_from_camera_by_tape.translation()).norm();
}

std::vector<calibration::LightGuess> lamp_guesses(const RigFile& rig) {
  return {{.name = "front lamp", .position = rig.front_lamp_mm, .aim = rig.lamp_aim_mm},
          {.name = "back lamp", .position = rig.back_lamp_mm, .aim = rig.lamp_aim_mm}};
}

calibration::LightOptions light_options(const RigFile& rig, cv::Size picture) {
  return {.albedo = rig.spectralon.albedo, .image_size = picture};
}

calibration::Lens engraved_lens(const RigFile& rig, cv::Size picture) {
  const double scale = static_cast<double>(picture.width) / picture_size(rig).width;
  return calibration::plain_lens(scale * rig.focal_length_guess_px, picture.width, picture.height);
}

calibration::PanelBench panel_bench(const RigFile& rig) {
  return {.camera = {.lens = engraved_lens(rig, picture_size(rig)), .world_from_camera = rig.world_from_camera_by_tape},
          .white_mm = rig.spectralon.white_mm,
          .plate_mm = rig.spectralon.plate_mm,
          .tags = rig.spectralon.tags,
          .centre = {0, 0, rig.platform_height_mm + calibration::kLedgeHeight_mm + rig.spectralon.plate_mm / 3},
          .lowest_mm = rig.platform_height_mm + kClear_mm};
}

}  // namespace station
