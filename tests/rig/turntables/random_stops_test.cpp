// A thousand stops at random moments of moves, on both simulations of GRBL and on the Zaber stage: how far the platform
// goes on, and whether anybody still knows where it stands.
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "tests/rig/turntables/documented_bench.h"
#include "tests/rig/turntables/wired_bench.h"

namespace {

using rig::kDegree;

constexpr int kStops = 1000;
constexpr unsigned kSeed = 1126;
constexpr double kStepRad = kDegree / 40;

struct Bench {
  std::string name;
  EventfulClock& clock;
  std::unique_ptr<rig::Turntable> table;
  std::function<double()> true_rad;
};

// Moves somewhere and stops on the way; the way that it went on for (radians), nothing when it had arrived.
std::optional<double> stopped_way(Bench& bench, std::mt19937& random) {
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
  EXPECT_NEAR(bench.table->angle_rad(), bench.true_rad(), kStepRad / 2);
  return std::abs(bench.true_rad() - told_rad.value_or(from_rad));
}

}  // namespace

TEST(RandomStops, AThousandOfThemEndWithinFiveDegreesAndKeepThePosition) {
  std::cout << "seed " << kSeed << "\n";
  std::mt19937 random(kSeed);
  // At full speed these would need 12 degrees to stand.
  constexpr double kFastDegS = 120;
  WiredBench<EventfulClock> grbl(Protocol::grbl, rig::HomeBy::home_switch, {}, kFastDegS),
      zaber(Protocol::zaber, rig::HomeBy::home_switch, {}, kFastDegS);
  DocumentedBench documented;
  std::vector<Bench> benches;
  benches.push_back({"GRBL", grbl.clock, grbl.make_turntable(), [&] { return grbl.true_angle_rad(); }});
  benches.push_back({"Zaber", zaber.clock, zaber.make_turntable(), [&] { return zaber.true_angle_rad(); }});
  benches.push_back(
      {"documented GRBL", documented.clock, documented.make_turntable(), [&] { return documented.at_rad(); }});
  for (Bench& bench : benches) {
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
