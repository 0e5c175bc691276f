#include "station/bench/bench_fault.h"

#include <utility>

namespace station {
namespace {

class BenchCamera final : public rig::Camera {
 public:
  explicit BenchCamera(std::unique_ptr<rig::Camera> camera) : camera_(std::move(camera)) {}
  rig::CameraIdentity identity() override {
    return on_bench([&] { return camera_->identity(); });
  }
  std::vector<double> shutter_times_s() override {
    return on_bench([&] { return camera_->shutter_times_s(); });
  }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override {
    return on_bench([&] { return camera_->configure(wanted); });
  }
  rig::Picture capture() override {
    return on_bench([&] { return camera_->capture(); });
  }
  std::vector<std::byte> preview() override {
    return on_bench([&] { return camera_->preview(); });
  }

 private:
  std::unique_ptr<rig::Camera> camera_;
};

class BenchTurntable final : public rig::Turntable {
 public:
  explicit BenchTurntable(std::unique_ptr<rig::Turntable> turntable) : turntable_(std::move(turntable)) {}
  void home() override {
    on_bench([&] { turntable_->home(); });
  }
  void move_to(double angle_rad) override {
    on_bench([&] { turntable_->move_to(angle_rad); });
  }
  void stop() override {
    on_bench([&] { turntable_->stop(); });
  }
  double angle_rad() override {
    return on_bench([&] { return turntable_->angle_rad(); });
  }
  rig::TurntableState state() override {
    return on_bench([&] { return turntable_->state(); });
  }
  void stands_at(double angle_rad) override {
    on_bench([&] { turntable_->stands_at(angle_rad); });
  }

 private:
  std::unique_ptr<rig::Turntable> turntable_;
};

}  // namespace

std::unique_ptr<rig::Camera> throwing_bench_faults(std::unique_ptr<rig::Camera> camera) {
  return std::make_unique<BenchCamera>(std::move(camera));
}

std::unique_ptr<rig::Turntable> throwing_bench_faults(std::unique_ptr<rig::Turntable> turntable) {
  return std::make_unique<BenchTurntable>(std::move(turntable));
}

}  // namespace station
