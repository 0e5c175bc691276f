#include "rig/turntables/zaber_reply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

TEST(ZaberReply, ReadsTheDocumentedReply) {
  const auto reply = rig::parse_zaber_line("@01 0 OK IDLE -- 0");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->device, 1);
  EXPECT_EQ(reply->axis, 0);
  EXPECT_FALSE(reply->message);
  EXPECT_TRUE(reply->accepted);
  EXPECT_FALSE(reply->busy);
  EXPECT_EQ(reply->warning, "--");
  EXPECT_EQ(reply->data, "0");
}

TEST(ZaberReply, ReadsMessageNumbersWarningsRejectionsAndSeveralWords) {
  const auto reply = rig::parse_zaber_line("@12 1 07 RJ BUSY WR BADDATA and more");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->device, 12);
  EXPECT_EQ(reply->message, 7);
  EXPECT_FALSE(reply->accepted);
  EXPECT_TRUE(reply->busy);
  EXPECT_EQ(reply->warning, "WR");
  EXPECT_EQ(reply->data, "BADDATA and more");
}

TEST(ZaberReply, BelievesALineWithACheckSumOnlyWhenItIsRight) {
  const std::string text = "01 1 05 OK IDLE -- 1234";
  EXPECT_TRUE(rig::parse_zaber_line("@" + text + ":" + rig::zaber_check_sum(text)));
  EXPECT_FALSE(rig::parse_zaber_line("@" + text + ":00"));
  std::string lost = text;
  lost.erase(20, 1);
  EXPECT_FALSE(rig::parse_zaber_line("@" + lost + ":" + rig::zaber_check_sum(text)));
}

TEST(ZaberReply, ItsCheckSumMakesTheBytesAddUpToNothing) {
  for (const std::string text : {"1 1 home", "", "1 1 99 move abs -123456"}) {
    unsigned sum = static_cast<unsigned>(std::stoul(rig::zaber_check_sum(text), nullptr, 16));
    for (const char c : text) sum += static_cast<unsigned char>(c);
    EXPECT_EQ(sum % 256, 0u) << text;
  }
}

TEST(ZaberReply, TakesNothingElseForAReply) {
  for (const char* line : {"", "@", "#01 0 info", "!01 1 IDLE --", "@1 0 OK IDLE -- 0", "@01 0 OK IDLE --",
                           "@01 0 OK IDLE -- ", "@01 0 NO IDLE -- 0", "@01 0 OK HALF -- 0", "@01 0 OK IDLE W 0",
                           "x@01 0 OK IDLE -- 0", "@01 0 OK IDLE -- \xff", "/1 1 get pos"})
    EXPECT_FALSE(rig::parse_zaber_line(line)) << line;
}

TEST(ZaberReply, EveryWarningAndRejectionIsSaidInWords) {
  for (const char* warning : {"WR", "FS", "FD", "WV", "WT", "WM", "XX"})
    EXPECT_THAT(rig::zaber_warning_words(warning), testing::StartsWith(std::string("warning ") + warning + ": "));
  for (const char* reason : {"BADDATA", "BADCOMMAND", "BADAXIS", "STATUSBUSY", "PARKED", "ELSE"})
    EXPECT_THAT(rig::zaber_rejection_words(reason), testing::StartsWith(std::string(reason) + ": "));
}
