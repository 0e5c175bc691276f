// The rig's simulated camera before a known picture, which is the truth of the tests on sensors.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "calibration/sensor/photon_transfer.h"
#include "calibration/sensor/picture_stack.h"
#include "rig/simulated/simulated_bench.h"

namespace simulated_sensor {

// The radiance at (column, row) of the sensor, in the radiance unit, grey.
using Scene = std::function<double(double column, double row)>;

// A sensor with the defects of the documented rig file, but more bad pixels.
rig::TrueSensor defective_sensor();

// The camera; `lamp` tells how the lamp's output changes with time.
class Camera {
 public:
  Camera(rig::TrueSensor sensor, std::uint64_t seed, rig::LampChanges lamp = {}, cv::Size size = {600, 400});

  // Puts a scene before the camera, lit by the lamp; an empty function is darkness.
  void look_at(const Scene& scene);
  calibration::SensorPicture photograph(double nominal_s);
  void wait_s(double duration_s) { clock_.sleep_s(duration_s); }
  double now_s() { return clock_.monotonic_s(); }
  const rig::BenchTruth& truth() const { return bench_.truth(); }

 private:
  Scene scene_;
  int views_ = 0;
  rig::SimulatedBench bench_;
  rig::SimulatedClock clock_{1.8e9};
  std::unique_ptr<rig::Camera> camera_;
};

// The scene of a white panel on a black ground, unevenly lit, brightest at 5 per second.
double white_panel(double column, double row);

struct Calibrated {
  calibration::DarkFit darks;
  calibration::FlatFit flats;
  calibration::PhotonTransfer transfer;  // with the maps in its response
  std::vector<calibration::PairLevels> ladder;
};

// Calibrates from dark frames, flats, and pairs up and down a ladder of whole stops around `reference_s` in the panel's
// light.
Calibrated calibrate(Camera& camera, double reference_s = 1 / 6.0);

}  // namespace simulated_sensor
