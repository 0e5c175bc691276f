// A small bench photographed by a simulated camera of one of the makes on this computer's network.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "rig/simulated/ptpip_server.h"
#include "rig/simulated/simulated_bench.h"
#include "rig/simulated/simulated_body.h"

// A camera that keeps what the bench's camera drew, to be compared with what came over the wire; may be asked from any
// thread.
class RecordingCamera final : public rig::Camera {
 public:
  explicit RecordingCamera(rig::Camera& camera) : camera_(camera) {}
  rig::CameraIdentity identity() override { return camera_.identity(); }
  std::vector<double> shutter_times_s() override { return camera_.shutter_times_s(); }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override { return camera_.configure(wanted); }
  rig::Picture capture() override {
    const rig::Picture picture = camera_.capture();
    const std::lock_guard hold(mutex_);
    taken_.push_back(picture);
    return picture;
  }
  std::vector<std::byte> preview() override { return camera_.preview(); }
  std::size_t count() const {
    const std::lock_guard hold(mutex_);
    return taken_.size();
  }
  rig::Picture last() const {
    const std::lock_guard hold(mutex_);
    return taken_.at(taken_.size() - 1);
  }
  void forget() {
    const std::lock_guard hold(mutex_);
    taken_.clear();
  }

 private:
  rig::Camera& camera_;
  mutable std::mutex mutex_;
  std::deque<rig::Picture> taken_;
};

// A simulated camera that lets a test act when it hears a question.
class WatchedBody final : public rig::SimulatedBody {
 public:
  WatchedBody(rig::SimulatedBody& body, std::function<void()> before_answer)
      : body_(body), before_answer_(std::move(before_answer)) {}
  rig::PtpAnswer handle(const rig::PtpRequest& request) override {
    if (before_answer_) before_answer_();
    return body_.handle(request);
  }
  std::string name() const override { return body_.name(); }
  int waiting_pictures() override { return body_.waiting_pictures(); }
  std::optional<std::pair<std::uint16_t, std::uint32_t>> picture_event() const override {
    return body_.picture_event();
  }
  void set_condition(const rig::BodyCondition& condition) override { body_.set_condition(condition); }
  bool shows_live_view() override { return body_.shows_live_view(); }

 private:
  rig::SimulatedBody& body_;
  const std::function<void()> before_answer_;
};

struct WiredCamera {
  // Starts the server; `before_answer` is called in its thread.
  explicit WiredCamera(rig::CameraFaultPlan plan = {}, std::function<void()> before_answer = {},
                       rig::CameraMake camera_make = rig::CameraMake::sony)
      : make(camera_make), faults(std::move(plan)), watched(*body, std::move(before_answer)) {}
  static cv::Mat3f draw(const rig::BenchState& state) {
    cv::Mat3f picture(state.lens.height_px, state.lens.width_px);
    for (int row = 0; row < picture.rows; ++row)
      for (int column = 0; column < picture.cols; ++column)
        picture(row, column) = {0.01F * static_cast<float>(row), 0.01F * static_cast<float>(column), 0.2F};
    return picture;
  }
  std::string port() const {
    const std::string number = std::to_string(server->port());
    return "ptpip:127.0.0.1:" + number + ":" + number;
  }

  rig::CameraMake make;
  rig::CameraFaultPlan faults;
  rig::SimulatedBench bench{{.lens = {.width_px = 60, .height_px = 40}}, draw};
  rig::SimulatedClock clock{1.8e9};
  std::unique_ptr<rig::Camera> camera = rig::make_simulated_camera(bench, clock, make);
  RecordingCamera recorded{*camera};
  std::unique_ptr<rig::SimulatedBody> body = rig::make_simulated_body(recorded, make);
  WatchedBody watched;
  std::unique_ptr<rig::PtpipServer> server = rig::serve_on_ptpip(watched, 0, faults);
};
