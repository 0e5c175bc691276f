#include "tests/calibration/sensor/simulated_sensor.h"

#include <algorithm>
#include <cmath>

namespace simulated_sensor {
namespace {

rig::BenchTruth truth_of(const rig::TrueSensor& sensor, std::uint64_t seed, const rig::LampChanges& lamp,
                         cv::Size size) {
  rig::BenchTruth truth{.sensor = sensor, .lamp_changes = lamp, .seed = seed};
  truth.lens.width_px = size.width;
  truth.lens.height_px = size.height;
  return truth;
}

}  // namespace

rig::TrueSensor defective_sensor() {
  return {.defects = {.hot_fraction = 0.001,
                      .hot_dark_current_e_s = 2000,
                      .dead_fraction = 0.0005,
                      .noisy_fraction = 0.001,
                      .sensitivity_spread = 0.005,
                      .offset_spread_dn = 0.8,
                      .dust_spots = 6,
                      .dust_depth = 0.03,
                      .dust_radius_px = 12,
                      .nonlinearity = 0.004,
                      .shutter_spread = 0.004}};
}

Camera::Camera(rig::TrueSensor sensor, std::uint64_t seed, rig::LampChanges lamp, cv::Size size)
    : bench_(truth_of(sensor, seed, lamp, size),
             [this](const rig::BenchState& state) {
               cv::Mat3f drawn(state.lens.height_px, state.lens.width_px, cv::Vec3f());
               if (!scene_) return drawn;
               for (int row = 0; row < drawn.rows; ++row)
                 for (int column = 0; column < drawn.cols; ++column)
                   drawn(row, column) = cv::Vec3f::all(static_cast<float>(scene_(column, row)));
               return drawn;
             }),
      camera_(rig::make_simulated_camera(bench_, clock_)) {}

void Camera::look_at(const Scene& scene) {
  scene_ = scene;
  rig::Arrangement arrangement{.object = rig::BenchObject::spectralon,
                               .lamp = scene ? rig::Lamp::front : rig::Lamp::off};
  arrangement.pose.translation().x() = ++views_;  // drawn anew
  bench_.place(arrangement);
}

calibration::SensorPicture Camera::photograph(double nominal_s) {
  camera_->configure({.exposure_s = nominal_s});
  return calibration::read_sensor_bytes(camera_->capture().bytes, "simulated");
}

double white_panel(double column, double row) {
  const bool white = column > 150 && column < 450 && row > 80 && row < 330;
  return (white ? 5.0 : 0.15) * (0.75 + 0.25 * std::sin(column / 130) * std::cos(row / 170));
}

Calibrated calibrate(Camera& camera, double reference_s) {
  using calibration::PictureStack, calibration::SensorPicture;
  Calibrated out;
  camera.look_at({});
  PictureStack brief, lasting;
  for (int i = 0; i < 16; ++i)
    brief.add(camera.photograph(reference_s / 128)), lasting.add(camera.photograph(reference_s * 16));
  out.darks = calibration::fit_dark_maps(brief, lasting);

  std::vector<PictureStack> flats(2);
  for (std::size_t i = 0; i < flats.size(); ++i) {
    const double slope = i == 0 ? 1e-4 : -1e-4;
    camera.look_at([slope](double column, double row) { return 4 * (1 + slope * (column - 300) - 5e-5 * row); });
    for (int k = 0; k < 8; ++k) flats[i].add(camera.photograph(reference_s));
  }
  out.flats = calibration::fit_flat_maps(flats, 16383, out.darks.maps);

  camera.look_at(white_panel);
  std::vector<double> times;
  for (int stop = -7; stop <= 4; ++stop) times.push_back(reference_s * std::exp2(stop));
  std::vector<SensorPicture> up;
  std::vector<double> begin_s;
  for (const double time : times) begin_s.push_back(camera.now_s()), up.push_back(camera.photograph(time));
  const calibration::LevelBins bins = calibration::make_level_bins(camera.photograph(reference_s), out.darks.maps);
  for (std::size_t i = times.size(); i-- > 0;) {
    const double apart_s = camera.now_s() - begin_s[i];
    out.ladder.push_back(calibration::measure_pair(up[i], camera.photograph(times[i]), bins, out.darks.maps, apart_s));
  }
  out.transfer = calibration::fit_photon_transfer(out.ladder, out.darks, 15871, up[7].exposure_s);
  out.transfer.response.maps = out.darks.maps;
  return out;
}

}  // namespace simulated_sensor
