// Whatever a device refuses is the bench's fault, and what its person declines is not.
#include "station/bench/bench_fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>

#include "station/bench/rig_devices.h"
#include "station/documents/reader.h"
#include "tests/places.h"

namespace station {
namespace {

enum class Outcome { nothing, bench_fault, declined, other };

Outcome outcome_of(const std::function<void()>& work) {
  try {
    work();
    return Outcome::nothing;
  } catch (const BenchFault& fault) {
    EXPECT_STREQ(fault.what(), "the words of the device");
    return Outcome::bench_fault;
  } catch (const rig::Declined&) {
    return Outcome::declined;
  } catch (const std::exception&) {
    return Outcome::other;
  }
}

// Devices whose every function throws.
using Throw = std::function<void()>;

template <typename Answer>
Answer none(const Throw& thrown) {
  thrown();
  return {};
}

struct BrokenCamera final : rig::Camera {
  explicit BrokenCamera(Throw what) : thrown(std::move(what)) {}
  rig::CameraIdentity identity() override { return none<rig::CameraIdentity>(thrown); }
  std::vector<double> shutter_times_s() override { return none<std::vector<double>>(thrown); }
  rig::CameraSettings configure(const rig::CameraSettings&) override { return none<rig::CameraSettings>(thrown); }
  rig::Picture capture() override { return none<rig::Picture>(thrown); }
  std::vector<std::byte> preview() override { return none<std::vector<std::byte>>(thrown); }
  Throw thrown;
};

struct BrokenTurntable final : rig::Turntable {
  explicit BrokenTurntable(Throw what) : thrown(std::move(what)) {}
  void home() override { thrown(); }
  void move_to(double) override { thrown(); }
  void stop() override { thrown(); }
  double angle_rad() override { return none<double>(thrown); }
  rig::TurntableState state() override { return none<rig::TurntableState>(thrown); }
  Throw thrown;
};

void expect_of_every_function(const Throw& thrown, Outcome expected) {
  const auto camera = throwing_bench_faults(std::make_unique<BrokenCamera>(thrown));
  const auto turntable = throwing_bench_faults(std::make_unique<BrokenTurntable>(thrown));
  const std::map<std::string, std::function<void()>> functions{
      {"identity", [&] { camera->identity(); }},     {"shutter times", [&] { camera->shutter_times_s(); }},
      {"configure", [&] { camera->configure({}); }}, {"capture", [&] { camera->capture(); }},
      {"preview", [&] { camera->preview(); }},       {"home", [&] { turntable->home(); }},
      {"move", [&] { turntable->move_to(1); }},      {"stop", [&] { turntable->stop(); }},
      {"angle", [&] { turntable->angle_rad(); }},    {"state", [&] { turntable->state(); }},
  };
  for (const auto& [name, function] : functions) EXPECT_EQ(outcome_of(function), expected) << name;
}

TEST(BenchFaults, AreAllThatADeviceThrows) {
  expect_of_every_function([] { throw std::runtime_error("the words of the device"); }, Outcome::bench_fault);
  expect_of_every_function([] { throw std::logic_error("the words of the device"); }, Outcome::bench_fault);
  expect_of_every_function([] { throw BenchFault("the words of the device"); }, Outcome::bench_fault);
  expect_of_every_function([] {}, Outcome::nothing);
}

TEST(BenchFaults, AreNotWhatThePersonDeclinesWhoTurnsThePlatform) {
  expect_of_every_function([] { throw rig::Declined("not now"); }, Outcome::declined);
}

// One that is not there when it is opened, and one that refuses what it is asked.
TEST(BenchFaults, AreThoseOfTheDevicesThatARigFileNames) {
  RigFile wired = read_rig(std::string(DATA_DIR) + "/rigs/grbl_sony_usb.json");
  wired.operator_driver = "simulated";
  wired.turntable_wire->line = TurntableWire::Line::pty;
  wired.turntable_wire->port.port = "/dev/pts/none";
  EXPECT_THROW(open_turntable(wired, nullptr), BenchFault);
  const RigFile simulated = read_rig(std::string(DATA_DIR) + "/rigs/simulated.json");
  EXPECT_THROW(open_turntable(simulated, nullptr).turntable->move_to(1), BenchFault) << "before it was homed";
}

}  // namespace
}  // namespace station
