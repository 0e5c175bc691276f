// Faults of the bench, the camera and the person while a session is captured, on the simulated bench with all checks.
// The numbers are rows of the list of faults that a station has to survive.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "station/bench/bench_picture.h"
#include "station/bench/mounted_holder.h"
#include "station/documents/degree.h"
#include "tests/places.h"
#include "tests/station/session/recorded_bench.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(SessionFaults, WithoutAFaultEveryViewIsGoodAndEveryCheckThatCanLookLooks) {
  RecordedBench bench;
  EXPECT_EQ(bench.run(), "");
  EXPECT_EQ(bench.outcome(), "complete");
  EXPECT_THAT(bench.refused(), IsEmpty());
  for (const auto& [step, picture] : pictures_of(bench.path)) {
    EXPECT_EQ(picture.verdict.grade(), Grade::good) << step << ": " << picture.verdict.reason();
    std::vector<const char*> checks = {"settings", "tags", "focus"};
    if (picture.kind == StepKind::pose) checks.insert(checks.end(), {"angle", "bench", "motion", "orientation"});
    if (picture.kind == StepKind::view) checks.insert(checks.end(), {"saturation", "exposure", "lamp", "lamp_side"});
    for (const char* check : checks) EXPECT_NE(picture.verdict.find(check), nullptr) << step << " " << check;
  }
}

// The turntable acknowledges, is read back as asked, and has not turned.
TEST(SessionFaults, APlatformThatSlippedIsFoundByItsTagsAndNothingWrongIsKept) {
  RecordedBench bench;
  int moves = 0;
  double asked_rad = 0;
  bool slips = true;
  bench.on_move = [&](rig::Turntable& device, double angle_rad) {
    asked_rad = angle_rad;
    device.move_to(angle_rad + (slips && ++moves > 1 ? 2 * kDegree : 0));
  };
  bench.on_read = [&](rig::Turntable&) { return asked_rad; };
  EXPECT_THAT(bench.run(), HasSubstr("slipped or lost steps"));
  EXPECT_EQ(bench.outcome(), "suspended");
  EXPECT_EQ(pictures_of(bench.path).size(), 1U) << "the first pose picture was taken before it slipped";
  slips = false;
  EXPECT_EQ(bench.run(), "");
  EXPECT_TRUE(verify_session(bench.path).sound());
}

// The platform moves by a third of a degree while the shutter is open, too little for the angle's check.
TEST(SessionFaults, APictureTakenWhileThePlatformStillMovedIsTakenAgain) {
  RecordedBench bench;
  RecordedBench dry;  // says how many test pictures the first step takes
  dry.run();
  const auto records = dry.records();
  const auto metering = std::ranges::find(records, "metering", &JournalRecord::event);
  const int tests = metering->data.at("test_pictures").get<int>();
  int captures = 0;
  bench.on_capture = [&](rig::Camera& device) {
    if (++captures != tests + 1) return device.capture();
    const double angle_rad = bench.bench->state().platform_angle_rad;
    bench.bench->turn_platform(angle_rad + 0.35 * kDegree);
    const rig::Picture picture = device.capture();
    bench.bench->turn_platform(angle_rad);
    return picture;
  };
  EXPECT_EQ(bench.run(), "");
  EXPECT_THAT(bench.refused(), ElementsAre(HasSubstr("moved by")));
  EXPECT_TRUE(verify_session(bench.path).sound());
}

// The camera reads back what was asked and its file says another time.
TEST(SessionFaults, AFileWithAnotherExposureThanItsCameraSaysIsRefused) {
  RecordedBench bench;
  bench.on_capture = [](rig::Camera& device) {
    rig::Picture picture = device.capture();
    const rig::CameraSettings said = picture.settings;
    rig::CameraSettings other = said;
    other.exposure_s /= 4;
    device.configure(other);
    picture = device.capture();
    device.configure(said);
    picture.settings = said;
    return picture;
  };
  EXPECT_THAT(bench.run(), HasSubstr("set its dial to M"));
  EXPECT_EQ(bench.outcome(), "suspended");
  EXPECT_TRUE(fs::is_empty(bench.path / "raw"));
}

TEST(SessionFaults, ATruncatedRawFileIsRefusedAndKeptAside) {
  RecordedBench bench;
  std::string step;
  bool cut = true;
  bench.on_capture = [&](rig::Camera& device) {
    rig::Picture picture = device.capture();
    if (cut && step == "reflection-horizontal-2") picture.bytes.resize(picture.bytes.size() / 3);
    return picture;
  };
  const RunOptions watch{.progress = [&](const Progress& progress) { step = progress.step; }};
  EXPECT_THAT(bench.run(watch), HasSubstr("reflection-horizontal-2"));
  EXPECT_EQ(bench.outcome(), "suspended");
  EXPECT_FALSE(fs::exists(bench.path / "raw/reflection-horizontal-2.arw"));
  cut = false;
  EXPECT_EQ(bench.run(watch), "");
  EXPECT_TRUE(verify_session(bench.path).sound());
}

TEST(SessionFaults, ThreadsThatStandTheWrongWayAreFoundInTheFirstPosePicture) {
  RecordedBench bench;
  bool wrong = true;
  bench.on_arrange = [&](rig::Operator& device, rig::Arrangement wanted) {
    if (wrong) {
      wanted.mounting = rig::Mounting::vertical;
      wanted.pose = nominal_holder_pose(bench.asked.rig, bench.asked.spool.wrapping, wanted.mounting);
    }
    device.arrange(wanted);
  };
  const std::string said = bench.run();
  EXPECT_THAT(said, HasSubstr("horizontal threads and the holder stands with them vertical"));
  EXPECT_TRUE(fs::is_empty(bench.path / "raw"));
  wrong = false;
  EXPECT_EQ(bench.run(), "");
}

// The lamp stands wrong either way round.
TEST(SessionFaults, ALampOnTheWrongSideIsFoundInTheFirstView) {
  for (const rig::Lamp asked : {rig::Lamp::front, rig::Lamp::back}) {
    RecordedBench bench;
    const rig::Lamp other = asked == rig::Lamp::front ? rig::Lamp::back : rig::Lamp::front;
    bench.on_arrange = [&](rig::Operator& device, rig::Arrangement wanted) {
      if (wanted.lamp == asked) wanted.lamp = other;
      device.arrange(wanted);
    };
    EXPECT_THAT(bench.run(), HasSubstr(asked == rig::Lamp::front ? "in front of" : "behind"));
    EXPECT_EQ(bench.outcome(), "suspended");
    for (const auto& [step, picture] : pictures_of(bench.path)) EXPECT_NE(picture.lamp, asked) << step;
  }
}

// 8 % of the light are missing at first.
TEST(SessionFaults, ALampThatWarmsUpIsWaitedForByItsChip) {
  RecordedBench bench;
  bench.asked.rig.lamp_watch_s = 10;
  bench.asked.rig.simulation->truth.lamp_changes.warm_up = 0.08;
  bench.asked.rig.simulation->truth.lamp_changes.warm_up_s = 40;
  bench.bench = std::make_unique<rig::SimulatedBench>(bench.asked.rig.simulation->truth,
                                                      make_bench_picture(bench.asked.rig, bench.asked.spool));
  bench.camera = rig::make_simulated_camera(*bench.bench, *bench.clock);
  bench.turntable = rig::make_simulated_turntable(*bench.bench, *bench.clock);
  bench.person = rig::make_simulated_operator(*bench.bench);
  std::vector<std::string> said;
  EXPECT_EQ(bench.run({.said = [&](const std::string& line) { said.push_back(line); }}), "");
  EXPECT_GE(said.size(), 2U);
  for (const std::string& line : said) EXPECT_THAT(line, HasSubstr("the lamp is warming up"));
  const auto records = bench.records();
  EXPECT_EQ(std::ranges::count(records, "lamp_watch", &JournalRecord::event), 1);
  const auto pictures = pictures_of(bench.path);
  const auto lamp = [&](const char* step) { return *pictures.at(step).verdict.find("lamp")->value; };
  // What the lamp then still lacks changes by less than a percent in the seconds of three views; the chip is read to
  // 0.3 %.
  EXPECT_NEAR(lamp("reflection-horizontal-3"), lamp("reflection-horizontal-1"), 1.5);
}

// Somebody turned the ring between the pose pictures and the third view.
TEST(SessionFaults, AViewOutOfFocusIsRefused) {
  RecordedBench bench;
  Plan longer;
  const Plan whole = read_session_file(recorded_session()).plan;
  for (const PlanStep& step : whole.steps)
    if (step.mounting == rig::Mounting::horizontal && step.lamp != rig::Lamp::back && step.kind != StepKind::dark)
      longer.steps.push_back(step);
  bench.asked.plan = longer;
  rig::BenchTruth blurred = bench.asked.rig.simulation->truth;
  blurred.lens.blur_px = 4;
  rig::SimulatedBench other(blurred, make_bench_picture(bench.asked.rig, bench.asked.spool));
  const auto soft = rig::make_simulated_camera(other, *bench.clock);
  std::string step;
  bench.on_arrange = [&](rig::Operator& device, const rig::Arrangement& wanted) {
    device.arrange(wanted);
    other.place(wanted);
  };
  bench.on_capture = [&](rig::Camera& device) {
    if (step != "reflection-horizontal-5") return device.capture();
    other.turn_platform(bench.bench->state().platform_angle_rad);
    const rig::Picture sharp = device.capture();
    soft->configure(sharp.settings);
    return soft->capture();
  };
  EXPECT_THAT(bench.run({.progress = [&](const Progress& progress) { step = progress.step; }}),
              HasSubstr("of the detail of the views before it"));
  EXPECT_FALSE(pictures_of(bench.path).contains("reflection-horizontal-5"));
  EXPECT_TRUE(pictures_of(bench.path).contains("reflection-horizontal-4"));
}

// The computer's clock goes back to 1970 and the camera's by an hour; order is the journal's numbers.
TEST(SessionFaults, ClocksThatJumpLoseNothing) {
  struct Jumping final : rig::Clock {
    rig::SimulatedClock before{1.8e9}, after{0};
    int asked = 0;
    double monotonic_s() override { return before.monotonic_s(); }
    std::string utc() override { return ++asked > 12 ? after.utc() : before.utc(); }
    void sleep_s(double duration_s) override { before.sleep_s(duration_s); }
  };
  RecordedBench bench;
  bench.clock = std::make_unique<Jumping>();
  bench.camera = rig::make_simulated_camera(*bench.bench, *bench.clock);
  bench.turntable = rig::make_simulated_turntable(*bench.bench, *bench.clock);
  EXPECT_EQ(bench.run(), "");
  EXPECT_LE(bench.refused().size(), 1U) << "the one picture that seemed to be older than the one before";
  EXPECT_TRUE(verify_session(bench.path).sound());
  std::uint64_t seq = 0;
  for (const JournalRecord& record : bench.records()) EXPECT_EQ(record.seq, ++seq);
}

TEST(SessionFaults, ASessionOfAnotherVersionIsRefusedAndNotTouched) {
  RecordedBench bench;
  EXPECT_EQ(bench.run(), "");
  for (const auto& [version, says] :
       {std::pair{0, "expected a whole number from 1"}, std::pair{2, "made by a later threadstation"}}) {
    nlohmann::json document = nlohmann::json::parse(text_of(bench.path / "session.json"));
    document["version"] = version;
    write_text(bench.path / "session.json", document.dump());
    const std::string journal = text_of(bench.path / "journal.jsonl");
    EXPECT_THAT(bench.run(), HasSubstr(says));
    EXPECT_EQ(text_of(bench.path / "journal.jsonl"), journal);
    EXPECT_FALSE(verify_session(bench.path).sound()) << "read, and said what is wrong";
  }
}

// Thin metal threads that face the lamp have a third of the detail that they have beside it, and are as sharp.
TEST(SessionFaults, ThreadsThatFaceTheLampAreNotTakenForALostFocus) {
  RecordedBench bench;
  bench.asked.spool = read_spool(fs::path(DATA_DIR) / "library" / "spools" / "metal_silver.json");
  bench.asked.plan.steps.clear();
  const Plan whole = read_session_file(recorded_session()).plan;
  for (const PlanStep& step : whole.steps)
    if (step.kind == StepKind::pose || (is_reflection(step) && step.mounting == rig::Mounting::horizontal))
      if (step.mounting == rig::Mounting::horizontal) bench.asked.plan.steps.push_back(step);
  bench.bench = std::make_unique<rig::SimulatedBench>(bench.asked.rig.simulation->truth,
                                                      make_bench_picture(bench.asked.rig, bench.asked.spool));
  bench.camera = rig::make_simulated_camera(*bench.bench, *bench.clock);
  bench.turntable = rig::make_simulated_turntable(*bench.bench, *bench.clock);
  bench.person = rig::make_simulated_operator(*bench.bench);
  EXPECT_EQ(bench.run(), "");
  EXPECT_THAT(bench.refused(), IsEmpty());
  double least = 1e9, most = 0;
  for (const auto& [step, picture] : pictures_of(bench.path)) {
    if (picture.kind != StepKind::view) continue;
    const Finding* focus = picture.verdict.find("focus");
    ASSERT_TRUE(focus && focus->value) << step;
    EXPECT_EQ(focus->grade, Grade::good) << step;
    least = std::min(least, *focus->value), most = std::max(most, *focus->value);
  }
  std::printf("detail from %.3f to %.3f\n", least, most);
  EXPECT_LT(least, 0.5 * most) << "otherwise nothing is tried here";
}

}  // namespace
}  // namespace station
