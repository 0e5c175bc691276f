// Ctrl-C reaches the motor in every state of the turntable, whatever the program waits for. The firmware stands on a
// pseudo-terminal and runs in real time; how long the stop took is printed.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <future>
#include <iostream>
#include <thread>

#include "rig/devices/clock.h"
#include "rig/simulated/pty_server.h"
#include "rig/turntables/controllers.h"
#include "rig/turntables/serial_line.h"
#include "rig/turntables/stepper_turntable.h"
#include "station/output/interrupt.h"

namespace {

using Clock = std::chrono::steady_clock;

// Sees when the firmware is told to stop.
class WatchedPort final : public rig::SimulatedPort {
 public:
  explicit WatchedPort(std::shared_ptr<rig::SimulatedPort> port) : port_(std::move(port)) {}
  void power_on() override { port_->power_on(); }
  void opened() override { port_->opened(); }
  void receive(std::string_view bytes) override {
    if (armed && (bytes.find('!') != std::string_view::npos || bytes.find('\x18') != std::string_view::npos) &&
        armed.exchange(false))
      told.set_value(Clock::now());
    port_->receive(bytes);
  }
  std::string transmit() override { return port_->transmit(); }
  void unplug() override { port_->unplug(); }
  bool plugged() override { return port_->plugged(); }
  int operations() override { return port_->operations(); }

  std::atomic<bool> armed = false;
  std::promise<Clock::time_point> told;

 private:
  std::shared_ptr<rig::SimulatedPort> port_;
};

struct EmergencyStop : testing::Test {
  EmergencyStop() {
    bench.turn_platform(3);
    setup.steps_per_deg = 40;
    setup.home_by = stepper.home_by = rig::HomeBy::home_switch;
    const rig::SimulatedMotor motor(bench, clock, 40);
    port = std::make_shared<WatchedPort>(rig::make_simulated_port(rig::make_simulated_grbl(motor, clock, true)));
    server = rig::serve_on_pty(port);
    table = rig::make_stepper_turntable(
        [this] { return rig::connect_grbl(rig::open_pty_line(server->path()), clock, setup); }, clock, stepper);
    station::watch_interrupts();
  }
  ~EmergencyStop() override { station::watch_interrupts(); }

  // This thread waits for the firmware alone: nothing but the signal can have told it.
  void expect_told(const std::string& state) {
    const station::StopOnInterrupt watch([this] { table->stop(); });
    auto told = port->told.get_future();
    port->armed = true;
    const auto begin = Clock::now();
    std::raise(SIGINT);
    const double took_ms = std::chrono::duration<double, std::milli>(told.get() - begin).count();
    std::cout << state << ": the firmware was told after " << took_ms << " ms\n";
  }

  void wait_until_it_turns() const {
    for (const double from = angle(); angle() == from;) std::this_thread::yield();
  }
  double angle() const { return bench.state().platform_angle_rad; }

  rig::SystemClock clock;
  rig::SimulatedBench bench{{.turntable = {.scale = 1, .step_rad = 0, .speed_rad_s = 3}},
                            [](const rig::BenchState&) { return cv::Mat3f(); }};
  rig::ControllerSetup setup;
  rig::StepperSetup stepper;
  std::shared_ptr<WatchedPort> port;
  std::unique_ptr<rig::PtyServer> server;
  std::unique_ptr<rig::Turntable> table;
};

}  // namespace

TEST_F(EmergencyStop, ReachesAPlatformThatTurns) {
  table->home();
  auto move = std::async(std::launch::async, [this] { table->move_to(6); });
  wait_until_it_turns();
  expect_told("turning");
  EXPECT_THROW(move.get(), std::runtime_error);
  EXPECT_EQ(table->state(), rig::TurntableState::stopped);
  EXPECT_LT(angle(), 5.9);
}

TEST_F(EmergencyStop, ReachesAPlatformThatLooksForItsHome) {
  auto homing = std::async(std::launch::async, [this] { table->home(); });
  wait_until_it_turns();
  expect_told("homing");
  EXPECT_THROW(homing.get(), std::runtime_error);
  EXPECT_EQ(table->state(), rig::TurntableState::unknown_position);
}

TEST_F(EmergencyStop, ReachesAPlatformThatStands) {
  table->home();
  expect_told("standing");
  EXPECT_EQ(table->state(), rig::TurntableState::stopped);
}
