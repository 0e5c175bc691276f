// A long session's worth of moves and pictures, with faults of both devices thrown in.
#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <cmath>
#include <iostream>
#include <map>
#include <random>
#include <set>

#include "rig/devices/degree.h"
#include "rig/simulated/simulated_port.h"
#include "rig/turntables/controllers.h"
#include "rig/turntables/stepper_turntable.h"
#include "tests/rig/cameras/gphoto_camera_fixture.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
extern "C" std::size_t __sanitizer_get_current_allocated_bytes();  // Debian's GCC comes without its header
#endif

namespace {

using rig::kDegree;

constexpr int kCaptures = 1000, kFaults = 20;  // 2 %
constexpr double kStepsPerDeg = 40;

// Memory of this program that is in use, in MB. A sanitizer keeps what was freed resident for a while, and counts.
double used_mb() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return static_cast<double>(__sanitizer_get_current_allocated_bytes()) / 1e6;
#else
  std::ifstream in("/proc/self/statm");
  double all = 0, resident = 0;
  in >> all >> resident;
  return resident * 4096 / 1e6;
#endif
}

struct LongRun : GphotoCamera {
  LongRun() {
    rig::SimulatedMotor motor(wired.bench, wired.clock, kStepsPerDeg);
    port = rig::make_simulated_port(rig::make_simulated_grbl(motor, wired.clock, true), line_faults());
    table = rig::make_stepper_turntable(
        [this] {
          return std::shared_ptr<rig::MotionController>(
              rig::connect_grbl(rig::open_simulated_line(port, wired.clock), wired.clock,
                                {.steps_per_deg = kStepsPerDeg, .home_by = rig::HomeBy::home_switch}));
        },
        wired.clock, {.home_by = rig::HomeBy::home_switch});
  }

  // About twenty operations a move.
  rig::LineFaultPlan line_faults() {
    using rig::LineFault;
    rig::LineFaultPlan plan;
    std::uniform_int_distribution<int> at(30, 20 * kCaptures), which(0, 7);
    const std::array kinds{LineFault::silence,  LineFault::lost_reply, LineFault::garbage, LineFault::late,
                           LineFault::repeated, LineFault::reset,      LineFault::alarm,   LineFault::unplug};
    for (int i = 0; i < kFaults / 2; ++i)
      plan.push_back({at(random), kinds.at(static_cast<std::size_t>(which(random)))});
    return plan;
  }

  void break_camera() {
    switch (std::uniform_int_distribution<int>(0, 3)(random)) {
      case 0:
        for (const pid_t child : children()) kill(child, SIGKILL);
        break;
      case 1:
        wired.server->cut_after(1000);
        break;
      case 2:
        wired.body->set_condition({.repeats_last_picture = true});
        break;
      default:
        wired.body->set_condition({.store_full = true});
    }
  }

  // What a person does when told: put it right, and go on where it stopped.
  template <typename Work>
  void until_done(const Work& work) {
    for (int tries = 0; tries < 4; ++tries) {
      try {
        work();
        return;
      } catch (const std::exception& error) {
        ++said[error.what()];
        wired.body->set_condition({});
        if (table->state() == rig::TurntableState::unknown_position) {
          port->power_on();
          table->home();
        }
      }
    }
    ADD_FAILURE() << "not done after four tries";
  }

  std::mt19937 random{20261121};
  std::shared_ptr<rig::SimulatedPort> port;
  std::unique_ptr<rig::Turntable> table;
  std::map<std::string, int> said;
};

}  // namespace

TEST_F(LongRun, AThousandCapturesWithFaultsInTwoPercentEndCompleteAndLeakNothing) {
  const auto camera = open();
  table->home();
  camera->configure({.exposure_s = 0.25, .iso = 100, .f_number = 8});
  std::set<int> breaks;
  while (breaks.size() < kFaults / 2) breaks.insert(std::uniform_int_distribution<int>(0, kCaptures - 1)(random));
  std::set<std::size_t> different;
  double early_mb = 0;
  std::size_t early_descriptors = 0;
  for (int capture = 0; capture < kCaptures; ++capture) {
    const double angle_rad = (capture % 120 - 60) * 1.5 * kDegree;
    until_done([&] { table->move_to(angle_rad); });
    EXPECT_NEAR(wired.bench.state().platform_angle_rad, angle_rad, kDegree / kStepsPerDeg / 2 + 1e-9);
    if (breaks.contains(capture)) break_camera();
    until_done([&] {
      const rig::Picture picture = camera->capture();
      EXPECT_TRUE(picture.bytes == wired.recorded.last().bytes) << capture;
      different.insert(
          std::hash<std::string_view>{}({reinterpret_cast<const char*>(picture.bytes.data()), picture.bytes.size()}));
    });
    wired.recorded.forget();
    wired.body->set_condition({});
    if (capture == 100) {
      early_mb = used_mb();
      early_descriptors = open_descriptors();
    }
  }
  EXPECT_EQ(different.size(), static_cast<std::size_t>(kCaptures));
  EXPECT_EQ(open_descriptors(), early_descriptors);
  EXPECT_LT(used_mb() - early_mb, 5);  // one raw file leaked each time would be 5 MB more
  std::cout << "in use " << early_mb << " MB after 100 captures, " << used_mb() << " MB after " << kCaptures
            << "; said on the way:\n";
  for (const auto& [message, times] : said) std::cout << "  " << times << " x " << message << "\n";
}
