// The simulated bench: one truth shared by a simulated camera, turntable and operator, so that moving the platform or
// the lamp changes the picture. The caller supplies the function that draws the bench (DrawPicture).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "rig/devices/camera.h"
#include "rig/devices/clock.h"
#include "rig/devices/turntable.h"
#include "rig/people/operator.h"
#include "rig/simulated/camera_make.h"
#include "rig/simulated/lamp_changes.h"
#include "rig/simulated/sensor_defects.h"

namespace rig {

struct TrueLens {
  int width_px = 600, height_px = 400;
  double fx_px = 2400, fy_px = 2400, cx_px = 299.5, cy_px = 199.5;
  std::array<double, 5> distortion{};  // OpenCV k1 k2 p1 p2 k3
  // v0, v1: gain = 1 + v0 r^2 + v1 r^4, r = distance to the image centre ((w - 1) / 2, (h - 1) / 2) over the half
  // diagonal hypot(w, h) / 2.
  std::array<double, 2> vignetting{};
  bool electronic_aperture = true;  // false: neither the body sets its aperture, nor do files tell it
  double blur_px = 0.0;             // blur of a lens out of focus: standard deviation of a Gaussian
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();  // OpenCV axes, mm
};

// A pixel's value = black level + (counted(Poisson(photo + dark electrons)) + normal(0, read noise)) * gain, rounded
// and kept within 0 and the white level; gain = ISO / 100 * (white - black) / full well [DN per electron]. `defects`
// holds the nonlinearity of counted() and the errors of single pixels and shutter times.
struct TrueSensor {
  double black_level_dn = 512, white_level_dn = 16383;  // as in the files, which have 14 bits
  double full_well_e = 50000;                           // electrons from black to white level at base ISO
  double read_noise_e = 5;
  double dark_current_e_s = 2;  // electrons per second
  SensorDefects defects{};
};

struct TrueTurntable {
  double scale = 1.0;     // true angle over reading
  double step_rad = 0.0;  // angles are whole multiples of it; 0: any angle
  double speed_rad_s = 0.5;
};

struct TrueLamp {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // where the operator put it; world, mm
  // RGB, radiance unit x mm^2 (irradiance at distance d facing: I / d^2).
  Eigen::Vector3d intensity = Eigen::Vector3d::Ones();
  double radius_mm = 4;
  // The beam: intensity falls off as cos^beam_exponent of the angle from the direction to `aim` (world, mm).
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
  // Radiance of a white diffuser under the room light, roughly.
  Eigen::Vector3d room_radiance = Eigen::Vector3d::Constant(0.3);
  double room_leak = 0.0;     // part of the room light that still shines when it should be off
  double placement_mm = 1.0;  // error of an object placed by hand (standard deviation per axis), with the next line
  double placement_rad = 0.01;
  double stand_placement_mm = 0;   // of a stand on the platform: at most, along either axis, evenly distributed
  double stand_placement_rad = 0;  // and its direction
  std::uint64_t seed = 1;
};

// All that the radiance reaching the lens depends on, at one instant.
struct BenchState {
  TrueLens lens{};
  Arrangement arrangement{};                                            // what the operator was asked for
  Eigen::Isometry3d world_from_object = Eigen::Isometry3d::Identity();  // where the object truly stands now
  double platform_angle_rad = 0.0;                                      // the true angle
  std::optional<TrueLamp> lamp{};
  Eigen::Vector3d room_radiance = Eigen::Vector3d::Zero();
  bool roughly = false;  // for live view
};

// True when a drawing of `a` is also one of `b`. The lens is not compared, because a bench has only one.
bool same_state(const BenchState& a, const BenchState& b);

// A function that draws the bench: the radiance (RGB, radiance unit = full scale per second at the image centre, base
// ISO and f/8) that falls on each pixel of the sensor, lens distortion included; height x width. The simulated camera
// adds vignetting, exposure, noise, mosaic and quantisation; values below zero count as no light. An exception that the
// function throws reaches the caller of capture() or preview().
using DrawPicture = std::function<cv::Mat3f(const BenchState&)>;

class SimulatedBench {
 public:
  SimulatedBench(BenchTruth truth, DrawPicture draw);

  const BenchTruth& truth() const { return truth_; }
  BenchState state() const;  // the truth at this instant
  cv::Mat3f draw() const { return draw_(state()); }
  cv::Mat3f draw_roughly() const;  // for live view: changes nothing in the pictures that come after it
  // The two parts of the picture, which add up: by the lamp alone at strength 1 (empty when it is off), and by all
  // other light (empty when there is none).
  cv::Mat3f draw_lamp() const;
  cv::Mat3f draw_without_lamp() const;

  // Places the object with the error of a hand, which depends only on the truth's seed and on the object, its mounting
  // and pose (not on the lights): asked again for the same, the hand places it the same. An object on the platform errs
  // only in its place and direction on the platform.
  void place(const Arrangement& arrangement);
  void place_anew();  // what stands there, with another error
  void turn_platform(double true_angle_rad) { platform_angle_rad_ = true_angle_rad; }

 private:
  void put(const Arrangement& arrangement);

  BenchTruth truth_;
  DrawPicture draw_;
  Arrangement arrangement_;
  std::uint64_t attempt_ = 0;  // how often it was placed anew
  Eigen::Isometry3d placed_pose_ = Eigen::Isometry3d::Identity();
  std::atomic<double> platform_angle_rad_ = 0.0;  // atomic, because a simulated motor turns it from its wire's thread
};

// Simulated devices that share one bench and one clock (both must outlive them).
// The camera draws only when the bench has changed since its last picture, or for live view since its last frame; the
// noise of pictures is fresh each time, and the lamp has the strength of the seconds on the clock during which the
// shutter is open. The camera offers thirds of stops; the light gathered goes with (8 / f)^2. Its files are described
// in rig/simulated/raw_writer.h. The turntable's position is unknown until it is homed; its angles are within +-360
// deg, on the truth's steps.
std::unique_ptr<Camera> make_simulated_camera(SimulatedBench& bench, Clock& clock, CameraMake make = CameraMake::sony);
std::unique_ptr<Turntable> make_simulated_turntable(SimulatedBench& bench, Clock& clock);
std::unique_ptr<Operator> make_simulated_operator(SimulatedBench& bench);

}  // namespace rig
