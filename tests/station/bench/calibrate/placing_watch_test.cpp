// What the live view says while a target is put down on the simulated bench.
#include "station/bench/calibrate/placing_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/jpeg.h"
#include "renderer/picture/picture_bytes.h"
#include "rig/devices/clock.h"
#include "rig/simulated/simulated_bench.h"
#include "station/bench/bench_picture.h"
#include "station/bench/calibrate/calibration_plan.h"
#include "station/output/interrupt.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station {
namespace {

using testing::HasSubstr;

// The simulated bench, drawn quickly, with a hand that puts stands exactly where they are wanted.
RigFile steady_rig() {
  RigFile rig = read_rig(std::string(DATA_DIR) + "/rigs/simulated.json");
  rig.simulation->target_samples_per_pixel = 2;
  rig.simulation->truth.stand_placement_mm = rig.simulation->truth.stand_placement_rad = 0;
  return rig;
}

struct Placing : testing::Test {
  RigFile rig = steady_rig();
  station_test::TemporaryFolder folder;
  rig::SimulatedClock clock{0, 0};
  rig::SimulatedBench bench{rig.simulation->truth, make_bench_picture(rig, std::nullopt)};
  std::unique_ptr<rig::Camera> camera = rig::make_simulated_camera(bench, clock, rig::CameraMake::sony);
  double now_s = 0;
  PlacingWatch watch{rig, *camera, folder / "live.jpg", [this] { return now_s; }};
  // How the board is first wanted: on stand 1, in the room's light.
  rig::Arrangement wanted = [this] {
    for (const CalibrationStep& step : make_calibration_plan(rig))
      if (step.role == CalibrationRole::lens) return step.arrangement;
    throw std::runtime_error("no board in the plan");
  }();

  PlacingWatch::Look after(double seconds) {
    now_s += seconds;
    return watch.look();
  }
};

TEST_F(Placing, ABoardThatStandsAsAskedIsTakenAfterASecondOfStillness) {
  bench.place(wanted);
  watch.begin(wanted, wanted, 0);
  ASSERT_TRUE(watch.watches());
  EXPECT_FALSE(after(0).stands) << "one frame says nothing of stillness";
  EXPECT_FALSE(after(0.4).stands);
  EXPECT_THAT(after(0.4).remark, HasSubstr("let go of it"));
  const PlacingWatch::Look stands = after(0.7);
  EXPECT_TRUE(stands.stands);
  EXPECT_FALSE(stands.hands_out);
  EXPECT_THAT(stands.remark, HasSubstr("Hands out of the box: the platform turns in 3 s."));
  EXPECT_THAT(after(1.2).remark, HasSubstr("turns in 2 s."));
  EXPECT_FALSE(after(1.2).hands_out);
  EXPECT_TRUE(after(1).hands_out);
  EXPECT_TRUE(watch.all_is_seen());
}

// The board stands as wanted, and what moves beside it is no part of it.
TEST_F(Placing, AHandBesideABoardThatStandsHoldsThePlatform) {
  bench.place(wanted);
  struct WithAHand final : rig::Camera {
    explicit WithAHand(rig::Camera& of) : camera(of) {}
    std::vector<std::byte> preview() override {
      const std::vector<std::byte> jpeg = camera.preview();
      cv::Mat3b frame = renderer::decode_jpeg({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
      if (hand_px >= 0) cv::rectangle(frame, {hand_px, 0, 60, 70}, {220, 150, 120}, cv::FILLED);
      const std::string encoded = renderer::encode_jpeg(frame);
      const auto* bytes = reinterpret_cast<const std::byte*>(encoded.data());
      return {bytes, bytes + encoded.size()};
    }
    rig::CameraIdentity identity() override { return camera.identity(); }
    std::vector<double> shutter_times_s() override { return camera.shutter_times_s(); }
    rig::CameraSettings configure(const rig::CameraSettings& settings) override { return camera.configure(settings); }
    rig::Picture capture() override { return camera.capture(); }
    rig::Camera& camera;
    int hand_px = -1;
  } seen(*camera);
  PlacingWatch watched{rig, seen, folder / "live.jpg", [this] { return now_s; }};
  watched.begin(wanted, wanted, 0);
  const auto look = [&](double seconds) {
    now_s += seconds;
    return watched.look();
  };
  look(0);
  for (int i = 0; i < 12; ++i) {
    seen.hand_px = 20 * (i % 2);
    EXPECT_FALSE(look(0.6).hands_out) << i;
  }
  seen.hand_px = -1;
  look(0.6);  // the hand leaves
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(look(0.5).hands_out) << i;
  EXPECT_TRUE(look(0.6).hands_out);
}

// Every live view is smaller than the camera's pictures.
TEST_F(Placing, AFrameOfHalfThePicturesSizeTellsTheSame) {
  RigFile larger = rig;
  larger.simulation->truth.lens.width_px *= 2, larger.simulation->truth.lens.height_px *= 2;
  larger.focal_length_guess_px *= 2;
  PlacingWatch by_small_frames(larger, *camera, folder / "live.jpg", [] { return 0.0; });
  bench.place(wanted);
  by_small_frames.begin(wanted, wanted, 0);
  EXPECT_THAT(by_small_frames.look().remark, HasSubstr("stands well"));
  rig::Arrangement aside = wanted;
  aside.pose.pretranslate(Eigen::Vector3d(-55, 0, 0));
  bench.place(aside);
  EXPECT_THAT(by_small_frames.look().remark, HasSubstr("cm too far back"));
}

TEST_F(Placing, WhereTheBoardIsMissingTheOutlineShowsWhereItIsWanted) {
  bench.place({.room_light = true});
  watch.begin(wanted, wanted, 0);
  const PlacingWatch::Look empty = after(0);
  EXPECT_FALSE(empty.stands);
  EXPECT_THAT(empty.remark, HasSubstr("Not enough of the printed target is seen"));
  const cv::Mat3b frame = renderer::decode_jpeg(renderer::bytes_of_picture(folder / "live.jpg"));
  ASSERT_EQ(frame.size(), cv::Size(600, 400));
  cv::Mat1b yellow;
  cv::inRange(frame, cv::Scalar(200, 140, 0), cv::Scalar(255, 255, 90), yellow);
  EXPECT_GT(cv::countNonZero(yellow), 300) << "the outline";
}

TEST_F(Placing, AnotherStandAnotherSideAndAnotherPlaceAreNotTakenForIt) {
  std::vector<rig::Arrangement> boards;
  for (const CalibrationStep& step : make_calibration_plan(rig))
    if (step.role == CalibrationRole::lens && (boards.empty() || boards.back().stand != step.arrangement.stand))
      boards.push_back(step.arrangement);
  ASSERT_EQ(boards.size(), 4U);
  for (const rig::Arrangement& placed : boards)
    for (const rig::Arrangement& asked : boards) {
      bench.place(placed);
      watch.begin(asked, asked, 0);
      for (int i = 0; i < 2; ++i) after(1.1);
      EXPECT_EQ(after(1.1).stands, placed.stand == asked.stand) << placed.stand << " for " << asked.stand;
    }
  rig::Arrangement aside = wanted;
  aside.pose.pretranslate(Eigen::Vector3d(-55, 0, 0));
  bench.place(aside);
  watch.begin(wanted, wanted, 0);
  EXPECT_THAT(after(0).remark, HasSubstr("cm too far back"));
}

TEST_F(Placing, AHandThatStillMovesItIsWaitedFor) {
  watch.begin(wanted, wanted, 0);
  for (int i = 0; i < 4; ++i) {
    rig::Arrangement moving = wanted;
    moving.pose.pretranslate(Eigen::Vector3d(0, 3.0 * i, 0));
    bench.place(moving);
    EXPECT_FALSE(after(0.6).stands) << i;
  }
}

TEST_F(Placing, WhereLightsAreToBeSwitchedAPersonSaysThatItIsDone) {
  bench.place(wanted);
  rig::Arrangement dark = wanted;
  dark.room_light = false;
  watch.begin(dark, wanted, 0);
  for (int i = 0; i < 3; ++i) after(0.6);
  EXPECT_FALSE(watch.all_is_seen());
  EXPECT_THAT(after(0.6).remark, HasSubstr("when the light is as asked for"));
  watch.begin(wanted, {.room_light = true}, 0);
  EXPECT_FALSE(watch.watches()) << "an empty platform has no target";
}

TEST_F(Placing, LiveViewChangesNothingInThePicturesThatComeAfterIt) {
  bench.place(wanted);
  rig::SimulatedBench other(rig.simulation->truth, make_bench_picture(rig, std::nullopt));
  other.place(wanted);
  const auto looked_at = rig::make_simulated_camera(other, clock, rig::CameraMake::sony);
  looked_at->preview();
  looked_at->preview();
  camera->configure({.exposure_s = 0.25});
  looked_at->configure({.exposure_s = 0.25});
  EXPECT_EQ(camera->capture().bytes, looked_at->capture().bytes);
}

// Answers nothing by itself.
struct SilentPerson final : rig::AskedPerson {
  std::optional<std::string> ask(const rig::Question& question) override {
    for (int i = 0; question.meanwhile && i < 20; ++i) {
      *now_s += 0.6;
      if (auto answer = question.meanwhile()) return answer;
    }
    return std::nullopt;
  }
  void prepare(const nlohmann::json&, const std::string&) override {}
  void remark(const std::string& seen) override { last = seen; }
  double* now_s = nullptr;
  std::string last;
};

TEST_F(Placing, AQuestionIsAnsweredByWhatIsSeenAndOnlyWhereThereIsATarget) {
  SilentPerson silent;
  silent.now_s = &now_s;
  WatchedPerson asked(silent);
  bench.place(wanted);
  EXPECT_EQ(asked.ask({.text = "Put it down."}), std::nullopt) << "nobody watches yet";
  asked.set_watch(&watch);
  EXPECT_EQ(asked.ask({.text = "Put it down."}), std::nullopt) << "nothing is looked for";
  watch.begin(wanted, wanted, 0);
  EXPECT_EQ(asked.ask({.text = "Put it down."}), rig::kDone);
  EXPECT_EQ(silent.last, "It stands well.");
}

TEST_F(Placing, CtrlCEndsAQuestionWhetherOrNotATargetIsLookedFor) {
  SilentPerson silent;
  silent.now_s = &now_s;
  WatchedPerson asked(silent);
  asked.set_watch(&watch);
  bench.place({.room_light = true});
  watch_interrupts();
  std::raise(SIGINT);
  EXPECT_EQ(asked.ask({.text = "Switch the light off."}), rig::kDecline);
  watch.begin(wanted, wanted, 0);
  EXPECT_EQ(asked.ask({.text = "Put it down."}), rig::kDecline);
  watch_interrupts();
  let_interrupts_end();
}

TEST_F(Placing, ALiveViewThatFailsIsSaidAndThePersonIsAskedAllTheSame) {
  SilentPerson silent;
  silent.now_s = &now_s;
  WatchedPerson asked(silent);
  PlacingWatch nowhere(rig, *camera, folder / "none" / "live.jpg", [this] { return now_s; });
  asked.set_watch(&nowhere);
  bench.place(wanted);
  nowhere.begin(wanted, wanted, 0);
  EXPECT_EQ(asked.ask({.text = "Put it down."}), std::nullopt);
  EXPECT_THAT(silent.last, HasSubstr("There is no live view: "));
  EXPECT_FALSE(nowhere.watches());
}

}  // namespace
}  // namespace station
