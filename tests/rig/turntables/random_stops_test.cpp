// A thousand stops at random moments of moves, on both simulations of GRBL and on the Zaber stage: how far the platform
// goes on, and whether anybody still knows where it stands. And hundreds of stops while it looks for its home.
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "tests/rig/turntables/documented_bench.h"
#include "tests/rig/turntables/wired_bench.h"

namespace {

using rig::kDegree;

constexpr int kStops = 1000, kHomings = 300;
constexpr unsigned kSeed = 1126;
constexpr double kMotorStepRad = kDegree / 40;

struct MovingBench {
  std::string name;
  EventfulClock& clock;
  std::unique_ptr<rig::Turntable> table;
  std::function<double()> true_rad;
};

// Moves somewhere and stops on the way; the way that it went on for (radians), nothing when it had arrived.
std::optional<double> stopped_way(MovingBench& bench, std::mt19937& random) {
  const double from_rad = bench.true_rad(), to_rad = std::uniform_real_distribution(-360.0, 360.0)(random) * kDegree,
               after_s =
                   std::uniform_real_distribution(0.0, 1.0)(random) * std::abs(to_rad - from_rad) / (22 * kDegree);
  std::optional<double> told_rad;
  bench.clock.plan(after_s, [&] {
    bench.table->stop();
    told_rad = bench.true_rad();
  });
  try {
    bench.table->move_to(to_rad);
    bench.clock.plan(0, [] {});
    return std::nullopt;
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("was stopped at"), std::string::npos) << error.what();
  }
  EXPECT_EQ(bench.table->state(), rig::TurntableState::stopped);
  EXPECT_NEAR(bench.table->angle_rad(), bench.true_rad(), kMotorStepRad / 2);
  return std::abs(bench.true_rad() - told_rad.value_or(from_rad));
}

// The way that a stop of homing takes (radians), from somewhere; nothing when it had ended.
std::optional<double> stopped_homing(MovingBench& bench, std::mt19937& random) {
  bench.table->home();
  bench.table->move_to(std::uniform_real_distribution(-360.0, 360.0)(random) * kDegree);
  std::optional<double> told_rad;
  bench.clock.plan(std::uniform_real_distribution(0.0, 10.0)(random), [&] {
    bench.table->stop();
    told_rad = bench.true_rad();
  });
  try {
    bench.table->home();
    bench.clock.plan(0, [] {});
    return std::nullopt;
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("home it again"), std::string::npos) << error.what();
  }
  bench.clock.sleep_s(5);
  if (bench.table->state() != rig::TurntableState::unknown_position) return std::nullopt;  // stopped behind its end
  return std::abs(bench.true_rad() - told_rad.value_or(1e9));
}

// At full speed these would need 12 degrees to stand.
struct ThreeBenches {
  static constexpr double kFastDegS = 120;
  WiredBench<EventfulClock> grbl{Protocol::grbl, rig::HomeBy::home_switch, {}, kFastDegS},
      zaber{Protocol::zaber, rig::HomeBy::home_switch, {}, kFastDegS};
  DocumentedBench documented;
  std::vector<MovingBench> all;

  ThreeBenches() {
    all.push_back({"GRBL", grbl.clock, grbl.make_turntable(), [this] { return seen(grbl); }});
    all.push_back({"Zaber", zaber.clock, zaber.make_turntable(), [this] { return seen(zaber); }});
    all.push_back(
        {"documented GRBL", documented.clock, documented.make_turntable(), [this] { return documented.at_rad(); }});
  }
  static double seen(WiredBench<EventfulClock>& bench) {
    bench.port->receive("");  // brings the motor up to the clock's time
    return bench.true_angle_rad();
  }
};

}  // namespace

TEST(RandomStops, WhileItLooksForItsHomeEndWithinFiveDegreesToo) {
  std::mt19937 random(kSeed);
  ThreeBenches benches;
  for (MovingBench& bench : benches.all) {
    double longest_rad = 0;
    int stops = 0;
    for (int homings = 0; homings < kHomings; ++homings) {
      if (const auto way_rad = stopped_homing(bench, random)) {
        ++stops;
        longest_rad = std::max(longest_rad, *way_rad);
      }
    }
    EXPECT_GT(stops, kHomings / 4) << bench.name;
    EXPECT_LE(longest_rad, 5 * kDegree) << bench.name;
    std::cout << bench.name << ": " << stops << " stops of homing, the longest way " << longest_rad / kDegree
              << " deg\n";
  }
}

TEST(RandomStops, AThousandOfThemEndWithinFiveDegreesAndKeepThePosition) {
  std::cout << "seed " << kSeed << "\n";
  std::mt19937 random(kSeed);
  ThreeBenches benches;
  for (MovingBench& bench : benches.all) {
    bench.table->home();
    double longest_rad = 0;
    int stops = 0;
    for (int moves = 0; stops < kStops && moves < 2 * kStops; ++moves) {
      if (const auto way_rad = stopped_way(bench, random)) {
        ++stops;
        longest_rad = std::max(longest_rad, *way_rad);
      }
    }
    EXPECT_EQ(stops, kStops);
    EXPECT_LE(longest_rad, 5 * kDegree) << bench.name;
    std::cout << bench.name << ": " << stops << " stops, the longest way " << longest_rad / kDegree << " deg\n";
  }
}
