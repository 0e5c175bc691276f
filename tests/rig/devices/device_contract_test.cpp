#include "rig/devices/device_contract.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <future>
#include <thread>

#include "rig/devices/degree.h"
#include "tests/rig/simulated/uniform_bench.h"

namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kStepRad = 0.0005;

rig::BenchTruth small_truth() {
  return {.lens = {.width_px = 60, .height_px = 40}, .turntable = {.scale = 1.001, .step_rad = kStepRad}};
}

std::vector<std::string> failed(const std::vector<rig::ContractRow>& rows) {
  std::vector<std::string> names;
  for (const rig::ContractRow& row : rows) {
    EXPECT_FALSE(row.what.empty()) << row.name;
    if (!row.passed) names.push_back(row.name);
  }
  return names;
}

// The simulated turntable with one of its functions put in a test's hands.
class AlteredTurntable final : public rig::Turntable {
 public:
  explicit AlteredTurntable(rig::Turntable& sound) : sound_(sound) {}
  void home() override { sound_.home(); }
  void move_to(double angle_rad) override { on_move(angle_rad); }
  void stop() override { on_stop(); }
  double angle_rad() override { return on_angle(); }
  rig::TurntableState state() override { return on_state(); }

  std::function<void(double)> on_move = [this](double angle_rad) { sound_.move_to(angle_rad); };
  std::function<void()> on_stop = [this] { sound_.stop(); };
  std::function<double()> on_angle = [this] { return sound_.angle_rad(); };
  std::function<rig::TurntableState()> on_state = [this] { return sound_.state(); };

 private:
  rig::Turntable& sound_;
};

class AlteredCamera final : public rig::Camera {
 public:
  explicit AlteredCamera(rig::Camera& sound) : sound_(sound) {}
  rig::CameraIdentity identity() override { return sound_.identity(); }
  std::vector<double> shutter_times_s() override { return on_times(); }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override { return on_configure(wanted); }
  rig::Picture capture() override { return on_capture(); }
  std::vector<std::byte> preview() override { return on_preview(); }

  std::function<std::vector<double>()> on_times = [this] { return sound_.shutter_times_s(); };
  std::function<rig::CameraSettings(rig::CameraSettings)> on_configure = [this](const rig::CameraSettings& wanted) {
    return sound_.configure(wanted);
  };
  std::function<rig::Picture()> on_capture = [this] { return sound_.capture(); };
  std::function<std::vector<std::byte>()> on_preview = [this] { return sound_.preview(); };

 private:
  rig::Camera& sound_;
};

struct TurntableContract : testing::Test {
  UniformBench rig{{0.1F, 0.1F, 0.1F}, small_truth()};
  rig::SimulatedClock paced{1.8e9, 0.02};
  std::unique_ptr<rig::Turntable> sound = rig::make_simulated_turntable(rig.bench, paced);
  AlteredTurntable table{*sound};
  std::vector<std::string> failures() { return failed(rig::check_turntable(table, kStepRad)); }
};

struct CameraContract : testing::Test {
  UniformBench rig{{0.1F, 0.1F, 0.1F}, small_truth()};
  AlteredCamera camera{*rig.camera};
  std::vector<std::string> failures() { return failed(rig::check_camera(camera)); }
};

}  // namespace

TEST_F(TurntableContract, IsKeptByTheSimulatedTurntable) {
  const auto rows = rig::check_turntable(*sound, kStepRad);
  EXPECT_THAT(failed(rows), IsEmpty());
  EXPECT_TRUE(rig::all_passed(rows));
  EXPECT_EQ(sound->angle_rad(), 0);
}

TEST_F(TurntableContract, IsBrokenByAReadingThatIsOff) {
  table.on_angle = [&] { return sound->angle_rad() * 1.01; };
  // A scale error does not show at 0; a quarter turn read 0.9 degrees off does.
  EXPECT_THAT(failures(), ElementsAre("a stop ends a move and keeps the position", "moves are reached and read back"));
}

TEST_F(TurntableContract, IsBrokenByPlayWhenReturning) {
  bool from_above = false;
  table.on_move = [&](double angle_rad) {
    const double before_rad = sound->angle_rad();
    sound->move_to(angle_rad);
    from_above = angle_rad < before_rad;
  };
  table.on_angle = [&] { return sound->angle_rad() + (from_above ? 0.6 * kStepRad : 0.0); };
  EXPECT_THAT(failures(), testing::Contains("returning to 0 reads the same"));
}

TEST_F(TurntableContract, IsBrokenByTakingAnyAngle) {
  table.on_move = [&](double angle_rad) { sound->move_to(std::isfinite(angle_rad) ? std::fmod(angle_rad, 6) : 0); };
  EXPECT_THAT(failures(), ElementsAre("an angle out of range is refused", "an angle that is not a number is refused",
                                      "an infinite angle is refused"));
}

TEST_F(TurntableContract, IsBrokenByAStopThatDoesNotStop) {
  table.on_stop = [] {};
  EXPECT_THAT(failures(), ElementsAre("a stop ends a move and keeps the position"));
}

TEST_F(TurntableContract, IsBrokenByAPlatformThatGoesOnForTwentyDegrees) {
  std::future<void> late;
  table.on_stop = [&] {
    late = std::async(std::launch::async, [&, until_rad = sound->angle_rad() + 20 * rig::kDegree] {
      while (sound->angle_rad() < until_rad) std::this_thread::yield();
      sound->stop();
    });
  };
  table.on_move = [&](double angle_rad) {
    if (late.valid()) late.get();
    sound->move_to(angle_rad);
  };
  EXPECT_THAT(failures(), ElementsAre("a stop ends a move and keeps the position"));
}

// A platform that a hand turns comes to its angle in one go; one with a motor is seen on its way.
TEST_F(TurntableContract, IsBrokenByAMotorThatIsNeverSeenTurning) {
  table.on_state = [&] {
    const auto state = sound->state();
    return state == rig::TurntableState::moving ? rig::TurntableState::idle : state;
  };
  EXPECT_THAT(failures(), ElementsAre("a stop ends a move and keeps the position"));
  EXPECT_THAT(failed(rig::check_turntable(table, kStepRad, false)), IsEmpty());
}

TEST_F(TurntableContract, IsBrokenByLosingThePositionAtAStop) {
  bool lost = false;
  table.on_stop = [&] {
    sound->stop();
    lost = true;
  };
  table.on_state = [&] { return lost ? rig::TurntableState::unknown_position : sound->state(); };
  EXPECT_THAT(failures(), ElementsAre("a stop ends a move and keeps the position", "moves are reached and read back",
                                      "homing works again"));
}

TEST_F(TurntableContract, IsBrokenByADeviceThatOnlyThrowsAndTheRowsSayWhatItSaid) {
  table.on_angle = []() -> double { throw std::runtime_error("the cable is out"); };
  const auto rows = rig::check_turntable(table, kStepRad);
  EXPECT_FALSE(rig::all_passed(rows));
  EXPECT_EQ(rows.front().what, "the cable is out");
}

TEST_F(CameraContract, IsKeptByTheSimulatedCamera) {
  EXPECT_THAT(failed(rig::check_camera(*rig.camera)), IsEmpty());
}

TEST_F(CameraContract, IsBrokenByATimeThatDoesNotStick) {
  camera.on_configure = [&](rig::CameraSettings wanted) {
    wanted.exposure_s = std::max(wanted.exposure_s, 0.5);
    return rig.camera->configure(wanted);
  };
  EXPECT_THAT(failures(), testing::Contains("settings are read back as asked"));
}

TEST_F(CameraContract, IsBrokenByRepeatingWhatWasAskedInsteadOfReadingBack) {
  camera.on_configure = [&](const rig::CameraSettings& wanted) {
    rig.camera->configure(wanted);
    return wanted;
  };
  EXPECT_THAT(failures(), ElementsAre("a shutter time that is not offered becomes one that is"));
}

TEST_F(CameraContract, IsBrokenByTakingAnyExposure) {
  camera.on_configure = [&](rig::CameraSettings wanted) {
    wanted.exposure_s = wanted.exposure_s > 0 ? wanted.exposure_s : 1;
    return rig.camera->configure(wanted);
  };
  EXPECT_THAT(failures(), ElementsAre("an exposure that is not a number is refused", "a negative exposure is refused"));
}

TEST_F(CameraContract, IsBrokenByTheSamePictureTwice) {
  rig::Picture kept;
  camera.on_capture = [&] {
    rig::Picture picture = rig.camera->capture();
    kept.bytes = kept.bytes.empty() ? picture.bytes : kept.bytes;
    picture.bytes = kept.bytes;
    return picture;
  };
  EXPECT_THAT(failures(), ElementsAre("each picture is a new one"));
}

TEST_F(CameraContract, IsBrokenByALiveViewThatIsNoPicture) {
  camera.on_preview = [] { return std::vector<std::byte>(1000); };
  EXPECT_THAT(failures(), ElementsAre("the live view shows a picture"));
}

TEST_F(CameraContract, IsBrokenByAClockThatStands) {
  camera.on_capture = [&] {
    rig::Picture picture = rig.camera->capture();
    picture.utc = "2026-11-21T10:20:30.123Z";
    return picture;
  };
  EXPECT_THAT(failures(), ElementsAre("each picture is a new one"));
}

TEST_F(CameraContract, IsBrokenByAnEmptyPicture) {
  camera.on_capture = [&] {
    rig::Picture picture = rig.camera->capture();
    picture.bytes.clear();
    return picture;
  };
  EXPECT_THAT(failures(),
              ElementsAre("a picture has bytes, a date and the settings asked", "each picture is a new one"));
}

TEST_F(CameraContract, IsBrokenByTimesOutOfOrder) {
  camera.on_times = [&] {
    auto times_s = rig.camera->shutter_times_s();
    std::swap(times_s.front(), times_s.back());
    return times_s;
  };
  EXPECT_THAT(failures(), ElementsAre("shutter times are offered in ascending order"));
}
