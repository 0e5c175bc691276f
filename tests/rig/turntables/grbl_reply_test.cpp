#include "rig/turntables/grbl_reply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rig/turntables/line_frames.h"

namespace {

template <typename Kind>
const Kind* as(const rig::GrblReply& reply) {
  return std::get_if<Kind>(&reply);
}

bool is_noise(const std::string& line) {
  const auto reply = rig::parse_grbl_line(line);
  return as<rig::GrblNoise>(reply) != nullptr;
}

rig::GrblStatus status(const std::string& line) {
  const auto reply = rig::parse_grbl_line(line);
  EXPECT_TRUE(as<rig::GrblStatus>(reply)) << line;
  return as<rig::GrblStatus>(reply) ? *as<rig::GrblStatus>(reply) : rig::GrblStatus{};
}

}  // namespace

TEST(GrblReply, ReadsEveryLineThatRealFirmwareWasSeenToSay) {
  EXPECT_TRUE(as<rig::GrblBanner>(rig::parse_grbl_line("Grbl 1.1h ['$' for help]")));
  EXPECT_TRUE(as<rig::GrblOk>(rig::parse_grbl_line("ok")));
  const auto version = rig::parse_grbl_line("[VER:1.1h.20190830:]");
  ASSERT_TRUE(as<rig::GrblMessage>(version));
  EXPECT_EQ(as<rig::GrblMessage>(version)->text, "VER:1.1h.20190830:");
  for (const char* line :
       {"[OPT:V,15,128]", "[MSG:Caution: Unlocked]", "[MSG:'$H'|'$X' to unlock]", "[MSG:Reset to continue]",
        "[G54:0.000,0.000,0.000]", "[G92:-2.000,0.000,0.000]", "[TLO:0.000]", "[PRB:0.000,0.000,0.000:0]"})
    EXPECT_TRUE(as<rig::GrblMessage>(rig::parse_grbl_line(line))) << line;
  const auto setting = rig::parse_grbl_line("$100=40.000");
  ASSERT_TRUE(as<rig::GrblSetting>(setting));
  EXPECT_EQ(as<rig::GrblSetting>(setting)->number, 100);
  EXPECT_EQ(as<rig::GrblSetting>(setting)->value, 40);
  for (const int code : {2, 3, 5, 9, 10, 22}) {
    const auto error = rig::parse_grbl_line("error:" + std::to_string(code));
    ASSERT_TRUE(as<rig::GrblError>(error));
    EXPECT_EQ(as<rig::GrblError>(error)->code, code);
  }
  for (const int code : {2, 3, 6, 8, 9}) {
    const auto alarm = rig::parse_grbl_line("ALARM:" + std::to_string(code));
    ASSERT_TRUE(as<rig::GrblAlarm>(alarm));
    EXPECT_EQ(as<rig::GrblAlarm>(alarm)->code, code);
  }
}

TEST(GrblReply, ReadsEveryStatusThatRealFirmwareWasSeenToReport) {
  using rig::GrblState;
  const rig::GrblStatus first = status("<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>");
  EXPECT_EQ(first.state, GrblState::idle);
  EXPECT_EQ(first.machine_deg, 0);
  EXPECT_EQ(first.work_offset_deg, 0);
  const rig::GrblStatus run = status("<Run|MPos:0.250,0.000,0.000|FS:720,0|Ov:100,100,100>");
  EXPECT_EQ(run.state, GrblState::run);
  EXPECT_EQ(run.machine_deg, 0.25);
  EXPECT_FALSE(run.work_offset_deg);
  EXPECT_EQ(status("<Hold:1|MPos:52.900,0.000,0.000|FS:180,0>").state, GrblState::hold_moving);
  EXPECT_EQ(status("<Hold:0|MPos:53.175,0.000,0.000|FS:0,0>").state, GrblState::hold);
  EXPECT_EQ(status("<Alarm|MPos:75.725,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>").state, GrblState::alarm);
  EXPECT_EQ(status("<Jog|MPos:1.000,0.000,0.000|FS:900,0>").state, GrblState::jog);
  EXPECT_EQ(status("<Home|MPos:1.000,0.000,0.000|FS:900,0>").state, GrblState::home);
  EXPECT_EQ(status("<Idle|MPos:-2.000,0.000,0.000|FS:0,0>").machine_deg, -2);
  const rig::GrblStatus work = status("<Idle|WPos:3.000,0.000,0.000|FS:0,0>");
  EXPECT_FALSE(work.machine_deg);
  EXPECT_EQ(work.work_deg, 3);
}

TEST(GrblReply, ReadsTheDialectsOfGrblhalAndFluidnc) {
  EXPECT_TRUE(as<rig::GrblBanner>(rig::parse_grbl_line("GrblHAL 1.1f ['$' or '$HELP' for help]")));
  EXPECT_TRUE(as<rig::GrblBanner>(rig::parse_grbl_line("Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]")));
  EXPECT_EQ(status("<Alarm:11|MPos:0.000,0.000,0.000,0.000|Bf:100,1023|FS:0,0>").state, rig::GrblState::alarm);
}

TEST(GrblReply, TakesNothingForAnOkThatIsNotExactlyOne) {
  for (const char* line : {"okok", "xok", "ok ", "OK", "\xffok", "o", "k", ""}) EXPECT_TRUE(is_noise(line)) << line;
}

TEST(GrblReply, SeesThatACharacterOfAPositionWasLost) {
  for (const char* line :
       {"<Idle|MPos:3.00,0.000,0.000|FS:0,0>", "<Idle|MPos:,0.000,0.000|FS:0,0>", "<Idle|MPos:3000,0.000,0.000|FS:0,0>",
        "<Idle|MPos:3.000|FS:0,0>", "<Idle|FS:0,0>", "<Idl|MPos:3.000,0.000,0.000|FS:0,0>", "<>", "<",
        "Idle|MPos:3.000,0.000,0.000|FS:0,0>", "<Idle|MPos:3.000,0.000,0.000|FS:0,0", "<Idle|MPos:nan,0.000,0.000>",
        "<Idle|MPos:1e9.000,0.000,0.000>"})
    EXPECT_TRUE(is_noise(line)) << line;
}

TEST(GrblReply, FindsAStatusThatRunsIntoOtherWords) {
  EXPECT_EQ(status("\xfe<Ru<Idle|MPos:3.000,0.000,0.000|FS:0,0>ok").machine_deg, 3);
  EXPECT_EQ(status("ok<Idle|MPos:3.000,0.000,0.000|FS:0,0>").machine_deg, 3);
}

TEST(GrblReply, EveryAlarmAndErrorIsSaidInWords) {
  for (int code = 0; code < 40; ++code) {
    EXPECT_THAT(rig::grbl_alarm_words(code), testing::StartsWith("alarm " + std::to_string(code) + ": "));
    EXPECT_THAT(rig::grbl_error_words(code), testing::StartsWith("error " + std::to_string(code) + ": "));
  }
}

TEST(LineFrames, MakeTheSameLinesHoweverTheBytesAreSplit) {
  const std::string text = "\r\nGrbl 1.1h ['$' for help]\r\nok\r\n<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\nerror:9\r\n";
  for (std::size_t piece = 1; piece <= text.size(); ++piece) {
    rig::LineFrames frames;
    std::vector<std::string> lines;
    for (std::size_t begin = 0; begin < text.size(); begin += piece) {
      frames.add(text.substr(begin, piece));
      while (const auto line = frames.next()) lines.push_back(*line);
    }
    EXPECT_THAT(lines, testing::ElementsAre("Grbl 1.1h ['$' for help]", "ok", "<Idle|MPos:0.000,0.000,0.000|FS:0,0>",
                                            "error:9"));
  }
}

TEST(LineFrames, StayBoundedWhenNoLineEnds) {
  rig::LineFrames frames;
  for (int i = 0; i < 10000; ++i) frames.add(std::string(1000, 'x'));
  frames.add("\nok\n");
  const auto noise = frames.next();
  ASSERT_TRUE(noise);
  EXPECT_LE(noise->size(), 1024u);  // as long as a line may be
  EXPECT_EQ(frames.next(), "ok");
}
