// The simulated bench: one truth shared by a simulated camera, turntable and operator, so that moving the platform or
// the lamp changes the picture. What it looks like is drawn by a function that the caller supplies (DrawPicture).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "rig/camera.h"
#include "rig/clock.h"
#include "rig/lamp_changes.h"
#include "rig/operator.h"
#include "rig/sensor_defects.h"
#include "rig/turntable.h"

namespace rig {

struct TrueLens {
  int width_px = 600, height_px = 400;
  double fx_px = 2400, fy_px = 2400, cx_px = 299.5, cy_px = 199.5;
  std::array<double, 5> distortion{};  // OpenCV k1 k2 p1 p2 k3
  // gain = 1 + v0 r^2 + v1 r^4, r = distance to the image centre ((w - 1) / 2, (h - 1) / 2) / half diagonal hypot(w,
  // h) / 2
  std::array<double, 2> vignetting{};
  double blur_px = 0.0;  // standard deviation of a Gaussian: out of focus
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();  // OpenCV axes, mm
};

// A pixel's value = black level + (counted(Poisson(photo + dark electrons)) + normal(0, read noise)) * gain, rounded
// and kept within 0 and the white level; gain = ISO / 100 * (white - black) / full well [DN per electron]; what counting
// loses, and what single pixels and shutter times have of their own: SensorDefects.
struct TrueSensor {
  double black_level_dn = 512, white_level_dn = 16383;  // as the files have them: 14 bits
  double full_well_e = 50000;                           // electrons from black to white level at base ISO
  double read_noise_e = 5;
  double dark_current_e_s = 2;  // electrons per second
  SensorDefects defects{};
};

struct TrueTurntable {
  double scale = 1.0;     // true angle / reading
  double step_rad = 0.0;  // quantisation
  double speed_rad_s = 0.5;
};

struct TrueLamp {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world, mm: where the operator put it
  Eigen::Vector3d intensity =
      Eigen::Vector3d::Ones();  // RGB, radiance unit x mm^2 (irradiance at distance d facing: I / d^2)
  double radius_mm = 4;
  // Its beam: intensity falls off as cos^beam_exponent of the angle from the direction to `aim` (world, mm).
  Eigen::Vector3d aim = Eigen::Vector3d::Zero();
  double beam_exponent = 0.0;
};

struct BenchTruth {
  TrueLens lens{};
  TrueSensor sensor{};
  TrueTurntable turntable{};
  TrueLamp front{}, back{}, front_left{};
  // Where the printed tags truly are: the ring glued on the platform, the sheet lying on the table.
  Eigen::Isometry3d platform_from_ring = Eigen::Isometry3d::Identity();  // platform frame at angle 0 = world
  Eigen::Isometry3d world_from_table_sheet = Eigen::Isometry3d::Identity();
  LampChanges lamp_changes{};
  Eigen::Vector3d room_radiance =
      Eigen::Vector3d::Constant(0.3);  // of a white diffuser under the room light, roughly
  double room_leak = 0.0;              // part of the room light that shines when it should be off
  double placement_mm = 1.0;           // a hand places an object this well (standard deviation per axis)
  double placement_rad = 0.01;
  std::uint64_t seed = 1;
};

// Everything that the radiance reaching the lens depends on, at one instant.
struct BenchState {
  TrueLens lens{};
  Arrangement arrangement{};                                            // as asked
  Eigen::Isometry3d world_from_object = Eigen::Isometry3d::Identity();  // as it truly stands now
  double platform_angle_rad = 0.0;                                      // true
  std::optional<TrueLamp> lamp{};
  Eigen::Vector3d room_radiance = Eigen::Vector3d::Zero();
};

// True when a drawing of `a` is a drawing of `b`; the lens is left out, a bench has only one.
bool same_state(const BenchState& a, const BenchState& b);

// Radiance (RGB, radiance unit = full scale per second at the image centre, base ISO and f/8) that falls on each
// pixel of the sensor, lens distortion included; height x width. Vignetting, exposure, noise, mosaic and quantisation
// are the simulated camera's; values below zero count as no light. What it throws reaches whoever asked for the
// picture.
using DrawPicture = std::function<cv::Mat3f(const BenchState&)>;

class SimulatedBench {
 public:
  SimulatedBench(BenchTruth truth, DrawPicture draw);

  const BenchTruth& truth() const { return truth_; }
  BenchState state() const;  // what is true now
  cv::Mat3f draw() const { return draw_(state()); }
  // Light adds: what the lamp alone gives at strength 1 (empty when it is off), and all other light (empty when there is
  // none beside the lamp's).
  cv::Mat3f draw_lamp() const;
  cv::Mat3f draw_without_lamp() const;

  // With the placement error of a hand, which depends only on the truth's seed and on the object, its mounting and
  // pose (not on the lights): asked again for the same, the hand places it the same. On the platform only the place
  // and the direction on it are uncertain.
  void place(const Arrangement& arrangement);
  void turn_platform(double true_angle_rad) { platform_angle_rad_ = true_angle_rad; }

 private:
  BenchTruth truth_;
  DrawPicture draw_;
  Arrangement arrangement_;
  Eigen::Isometry3d placed_pose_ = Eigen::Isometry3d::Identity();
  std::atomic<double> platform_angle_rad_ = 0.0;  // a simulated motor turns it from the thread of its wire
};

// Devices that share one bench and one clock (both must outlive them).
// Camera: draws only when the bench has changed since its last picture; the noise is fresh each time, and the lamp has the
// strength of the exposure's own seconds on the clock. It offers thirds of stops; light gathered goes with (8 / f)^2. Files: rig/raw_writer.h. Turntable: the position is unknown
// until it is homed; angles within +-360 deg, on the truth's steps.
std::unique_ptr<Camera> make_simulated_camera(SimulatedBench& bench, Clock& clock);
std::unique_ptr<Turntable> make_simulated_turntable(SimulatedBench& bench, Clock& clock);
std::unique_ptr<Operator> make_simulated_operator(SimulatedBench& bench);

}  // namespace rig
