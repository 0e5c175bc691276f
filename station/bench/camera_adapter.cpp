#include "station/bench/camera_adapter.h"

#include <string>

#include "calibration/develop/linear_grey.h"
#include "station/documents/text_pieces.h"

namespace station {

double f_number_of(const calibration::SensorPicture& picture) {
  return picture.f_number > 0 ? picture.f_number : rig::CameraSettings{}.f_number;
}

bool is_raw_file(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());  // with its point
  return !extension.empty() && rig::is_raw_extension(std::string_view(extension).substr(1));
}

renderer::Camera camera_of(const calibration::Lens& lens, const Eigen::Isometry3d& frame_from_camera,
                           bool undistorted) {
  renderer::Camera camera{.width = lens.width_px,
                          .height = lens.height_px,
                          .fx = lens.fx_px,
                          .fy = lens.fy_px,
                          .cx = lens.cx_px,
                          .cy = lens.cy_px,
                          .distortion = lens.distortion,
                          .world_from_camera = frame_from_camera};
  if (undistorted) camera.distortion = {};
  return camera;
}

calibration::Lens lens_of(const rig::TrueLens& lens) {
  return {lens.width_px, lens.height_px, lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, lens.distortion};
}

inversion::NearLight lamp_in_holder(const RigCalibration& calibration, const RigFile& rig, rig::Lamp place,
                                    const Eigen::Isometry3d& holder_from_world) {
  const calibration::LightFit& lamp = calibration.light;
  const bool by_tape = place == rig::Lamp::front_left;
  const std::size_t calibrated = place == rig::Lamp::back ? 1 : 0;
  const Eigen::Vector3d position = by_tape ? rig.front_left_lamp_mm : lamp.positions.at(calibrated);
  const Eigen::Vector3d axis =
      by_tape ? (rig.lamp_aim_mm - rig.front_left_lamp_mm).normalized() : lamp.beam_axes.at(calibrated);
  return {.position = holder_from_world * position,
          .intensity = lamp.intensity,
          .radius_mm = rig.lamp_radius_mm,
          .beam_axis = holder_from_world.linear() * axis,
          .beam_exponent = lamp.beam_exponent};
}

calibration::TagObservation tags_in(const calibration::SensorPicture& picture) {
  return calibration::detect_tags(calibration::linear_grey(picture));
}

}  // namespace station
