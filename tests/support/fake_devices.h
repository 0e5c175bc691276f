// Devices that answer at once. They are fakes, not the simulated bench: they do what a test tells them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rig/devices/camera.h"
#include "rig/devices/turntable.h"
#include "rig/people/operator.h"

namespace station {

class FakeCamera final : public rig::Camera {
 public:
  std::string serial = "123";
  rig::CameraSettings now;
  std::function<double()> radiance = [] { return 1.0; };  // picture level = radiance x exposure, at most 1
  int captures = 0;
  int fail_at_capture = 0;     // number of the capture that fails, from 1
  bool stuck_shutter = false;  // keeps its old exposure time and says so
  bool stale = false;          // delivers its last picture again and again
  int late_at = 0;             // from this capture on it delivers the picture before
  bool empty = false;
  bool lies = false;  // the picture was taken with another exposure than was read back

  rig::CameraIdentity identity() override { return {"Maker", "Model", serial, 600, 400}; }
  std::vector<double> shutter_times_s() override;
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override;
  rig::Picture capture() override;  // no two pictures are alike, also among processes
  std::vector<std::byte> preview() override { return {}; }

  static double level(const rig::Picture& picture);

 private:
  rig::Picture last_;
};

class FakeTurntable final : public rig::Turntable {
 public:
  bool homed = false, slips = false;
  double off_rad = 0;  // by how much the platform stands further than is read
  int stops = 0, moves = 0;
  std::function<void()> on_stop;
  std::function<void(double angle_rad)> on_move;  // called before the platform arrives; may throw

  void home() override { homed = true, angle_rad_ = 0; }
  void move_to(double angle_rad) override;
  void stop() override {
    ++stops;
    if (on_stop) on_stop();
  }
  double angle_rad() override { return angle_rad_; }
  rig::TurntableState state() override { return rig::TurntableState::idle; }
  void stands_at(double angle_rad) override {
    off_rad -= angle_rad - angle_rad_;
    angle_rad_ = angle_rad;
  }

 private:
  double angle_rad_ = 0;
};

class FakePerson final : public rig::Operator {
 public:
  std::vector<rig::Arrangement> asked;
  void arrange(const rig::Arrangement& wanted) override { asked.push_back(wanted); }
};

}  // namespace station
