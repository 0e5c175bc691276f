#include "tests/station/bench/calibrate/calibration_errors.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "calibration/geometry/lens_difference.h"
#include "station/bench/camera_adapter.h"
#include "station/documents/degree.h"

namespace station_test {
namespace {

using Eigen::Vector3d;
using station::kDegree;

const Vector3d kSpool(0, 0, 64);

template <typename Visit>
void about_the_spool(double reach_mm, Visit visit) {
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0})
      for (const double z : {-1.0, 0.0, 1.0}) visit(Vector3d(kSpool + reach_mm * Vector3d(x, y, z)));
}

// Independent of calibration's own model.
Vector3d true_irradiance(const rig::TrueLamp& lamp, const Vector3d& point) {
  const Vector3d to_point = point - lamp.position;
  const double cosine = to_point.normalized().dot((lamp.aim - lamp.position).normalized());
  return lamp.intensity * std::pow(cosine, lamp.beam_exponent) / to_point.squaredNorm();
}

calibration::ModelledLens modelled(const calibration::Lens& lens) {
  const auto& k = lens.distortion;
  return {calibration::LensModel::opencv5,
          {lens.width_px, lens.height_px},
          {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, k[0], k[1], k[2], k[3], k[4]}};
}

// Directions of the rays through a grid of pixels, unit, camera frame; one per column.
Eigen::Matrix3Xd rays(const calibration::Lens& lens) {
  std::vector<Eigen::Vector2d> pixels;
  for (int row = 1; row < 4; ++row)
    for (int column = 1; column < 6; ++column)
      pixels.emplace_back(column * lens.width_px / 6.0, row * lens.height_px / 4.0);
  Eigen::Matrix3Xd out(3, static_cast<Eigen::Index>(pixels.size()));
  Eigen::Index i = 0;
  for (const Eigen::Vector2d& pixel : undistort_points(lens, pixels))
    out.col(i++) =
        Vector3d((pixel.x() - lens.cx_px) / lens.fx_px, (pixel.y() - lens.cy_px) / lens.fy_px, 1).normalized();
  return out;
}

// The rotation that lays one bundle of rays best upon the other.
Eigen::Matrix3d rotation_between(const Eigen::Matrix3Xd& to, const Eigen::Matrix3Xd& from) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(to * from.transpose(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();  // small: never a reflection
}

void add_geometry(const station::RigCalibration& found, const rig::BenchTruth& truth, CalibrationErrors& errors) {
  const renderer::Camera camera = station::camera_of(found.lens.lens, found.platform.world_from_camera, false),
                         true_camera =
                             station::camera_of(station::lens_of(truth.lens), truth.lens.world_from_camera, false);
  double squares = 0, count = 0;
  about_the_spool(25, [&](const Vector3d& point) {
    squares += (renderer::project(camera, point) - renderer::project(true_camera, point)).squaredNorm();
    ++count;
  });
  errors.points_px = std::sqrt(squares / count);
  const double distance_mm = (truth.lens.world_from_camera.translation() - kSpool).norm();
  errors.lens_px = calibration::summary(projection_differences(modelled(station::lens_of(truth.lens)),
                                                               modelled(found.lens.lens), distance_mm))
                       .rms_px;
  const Eigen::Isometry3d from_world = found.platform.world_from_camera.inverse(),
                          truly_from_world = truth.lens.world_from_camera.inverse();
  const Vector3d axis = from_world.linear().col(2), true_axis = truly_from_world.linear().col(2);
  const Vector3d spool = truly_from_world * kSpool;
  const Vector3d along = true_axis.cross(spool.normalized()).normalized().cross(true_axis);
  errors.axis_in_frame_deg = axis.cross(true_axis).norm() / kDegree;
  const Eigen::Matrix3d turned = rotation_between(rays(station::lens_of(truth.lens)), rays(found.lens.lens));
  errors.axis_deg = (turned * axis).cross(true_axis).norm() / kDegree;
  errors.axis_along_mm = std::abs((from_world * kSpool - spool).dot(along));
  const double columns_px = renderer::project(camera, kSpool).x() - renderer::project(true_camera, kSpool).x();
  errors.axis_across_mm = std::abs(columns_px * spool.z() / truth.lens.fx_px);
  for (std::size_t i = 0; i < found.platform.angles_rad.size(); ++i) {
    const double true_rad = truth.turntable.scale * found.platform.readings_rad[i];
    errors.angle_deg = std::max(errors.angle_deg, std::abs(found.platform.angles_rad[i] - true_rad) / kDegree);
  }
}

void add_light(const calibration::LightFit& found, const rig::BenchTruth& truth, double lamp_strength,
               CalibrationErrors& errors) {
  for (std::size_t light = 0; light < 2; ++light) {
    const rig::TrueLamp& lamp = light == 0 ? truth.front : truth.back;
    errors.lamp_mm[light] = (found.positions.at(light) - lamp.position).norm();
    double squares = 0, count = 0;
    about_the_spool(40, [&](const Vector3d& point) {
      const Eigen::Array3d error =
          facing_irradiance(found, light, point).array() / (lamp_strength * true_irradiance(lamp, point)).array() - 1;
      squares += error.square().sum();
      count += 3;
      errors.worst_irradiance[light] = std::max(errors.worst_irradiance[light], error.abs().maxCoeff());
    });
    errors.irradiance[light] = std::sqrt(squares / count);
    errors.held_out[light] = held_out_error(found, static_cast<int>(light));
  }
}

void add_sensor(const calibration::SensorResponse& found, const rig::TrueSensor& truth, CalibrationErrors& errors) {
  const double gain = (truth.white_level_dn - truth.black_level_dn) / truth.full_well_e;
  errors.gain = std::abs(found.gain_dn_per_e / gain - 1);
  for (double light = 0.01; light < 1; light += 0.01) {
    const double signal = light * (1 - truth.defects.nonlinearity * light);
    if (signal < 0.85)
      errors.linearity = std::max(errors.linearity, std::abs(linear_signal(found, signal) / light - 1));
  }
}

}  // namespace

CalibrationErrors calibration_errors(const station::RigCalibration& found, const station::SimulatedRig& simulation,
                                     double lamp_strength) {
  CalibrationErrors errors;
  add_geometry(found, simulation.truth, errors);
  add_light(found.light, simulation.truth, lamp_strength, errors);
  if (found.sensor) add_sensor(found.sensor->response, simulation.truth.sensor, errors);
  errors.bow_mm = std::abs(found.lens.board_warp_mm.x() - simulation.board_bow_mm);
  errors.droop = std::abs(found.light.droop.sum() - simulation.spectralon_droop);
  return errors;
}

std::string heading() {
  return "bench        lens    points  axis: deg (in frame)  across  along  angles  lamps, mm    irradiance %, rms "
         "(worst)   "
         "   held "
         "out %"
         "   gain  linearity  bow   droop\n"
         "             px      px                           mm      mm     deg     front  back   front         back  "
         "        "
         "  front  "
         "back"
         "    %     %          mm    %\n";
}

std::string row(const std::string& bench, const CalibrationErrors& e) {
  char text[400];
  std::snprintf(
      text, sizeof text,
      "%-12s %-7.3f %-7.3f %.4f (%.4f)       %-6.3f  %-5.3f  %-6.4f  %-5.2f  %-5.2f  %.3f (%.3f) %.3f (%.3f)   "
      "%-5.2f  %-5.2f"
      "   %-5.2f %-9.3f  %-5.3f %.2f\n",
      bench.c_str(), e.lens_px, e.points_px, e.axis_deg, e.axis_in_frame_deg, e.axis_across_mm, e.axis_along_mm,
      e.angle_deg, e.lamp_mm[0], e.lamp_mm[1], 100 * e.irradiance[0], 100 * e.worst_irradiance[0],
      100 * e.irradiance[1], 100 * e.worst_irradiance[1], 100 * e.held_out[0], 100 * e.held_out[1], 100 * e.gain,
      100 * e.linearity, e.bow_mm, 100 * e.droop);
  return text;
}

}  // namespace station_test
