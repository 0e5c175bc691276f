// A recorded session played again: the same files, the same faults, no hardware.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/session/replay/played_devices.h"
#include "station/session/replay_session.h"
#include "tests/station/session/recorded_bench.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Replay, TheRecordedSessionIsMadeAgainFileForFile) {
  const TemporaryFolder folder;
  const ReplayReport report =
      replay_session(recorded_session(), {.session = folder / "again", .progress_style = ProgressStyle::quiet});
  EXPECT_THAT(report.differences, IsEmpty());
  EXPECT_EQ(report.state, RunState::complete);
  EXPECT_GT(report.files, 40U);
  EXPECT_TRUE(verify_session(folder / "again").sound());
  EXPECT_TRUE(verify_session(recorded_session()).sound());
}

TEST(Replay, AFaultThatWasRecordedHappensAgainAndSoDoesTheRunThatWentOn) {
  RecordedBench bench;
  bool dead = true;
  int captures = 0;
  bench.on_capture = [&](rig::Camera& device) {
    if (dead && ++captures == 7) throw std::runtime_error("the camera was asked for a picture and is gone; plug it in");
    return device.capture();
  };
  EXPECT_THAT(bench.run({}, {.record = true}), HasSubstr("plug it in"));
  dead = false;
  EXPECT_EQ(bench.run({}, {.record = true}), "");
  const TemporaryFolder folder;
  const ReplayReport report =
      replay_session(bench.path, {.session = folder / "again", .progress_style = ProgressStyle::quiet});
  EXPECT_THAT(report.differences, IsEmpty());
  EXPECT_EQ(report.runs, 2U);
  EXPECT_THAT(text_of(folder / "again/journal.jsonl"), HasSubstr("plug it in"));
}

TEST(Replay, WhatWasNotRecordedIsRefusedInOneLine) {
  RecordedBench bench;
  EXPECT_EQ(bench.run(), "");
  const TemporaryFolder folder;
  EXPECT_THAT(message_of([&] {
                replay_session(bench.path, {.session = folder / "x", .progress_style = ProgressStyle::quiet});
              }),
              HasSubstr("--record"));
  EXPECT_FALSE(fs::exists(folder / "x"));
}

TEST(Replay, AnotherQuestionThanTheRecordedOneNamesBoth) {
  const auto runs = read_device_log(recorded_session());
  const StandIns devices = play_strictly(runs.front(), recorded_pictures(recorded_session()));
  EXPECT_THAT(message_of([&] { devices.turntable->move_to(9); }), HasSubstr("where the recording has"));
}

TEST(Replay, AReplayThatWasEndedGoesOnAndEndsWhole) {
  const TemporaryFolder folder;
  replay_session(recorded_session(), {.session = folder / "again", .progress_style = ProgressStyle::quiet});
  // As after a pulled plug in the middle: half of the journal, and the files that nobody names yet.
  std::string journal = text_of(folder / "again/journal.jsonl");
  journal.resize(journal.size() / 2);
  write_text(folder / "again/journal.jsonl", journal);
  const ReplayReport report =
      replay_session(recorded_session(), {.session = folder / "again", .progress_style = ProgressStyle::quiet}, true);
  EXPECT_EQ(report.state, RunState::complete);
  EXPECT_TRUE(verify_session(folder / "again").sound());
  const auto recorded = pictures_of(recorded_session());
  for (const auto& [step, picture] : pictures_of(folder / "again"))
    EXPECT_EQ(picture.sha256, recorded.at(step).sha256) << step;
}

}  // namespace
}  // namespace station
