// The report of a session before it is developed, and what a crash while writing it leaves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/thread/report/session_report.h"
#include "tests/station/session/recorded_bench.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(SessionReport, IsMadeFromTheJournalAndAgainAfterACrash) {
  const TemporaryFolder folder;
  const fs::path session = folder / "session";
  fs::copy(recorded_session(), session, fs::copy_options::recursive);
  write_text(session / ".report.html.partial", "<html><bo");  // where the plug was pulled
  write_session_report(session);
  const std::string page = text_of(session / "report.html");
  for (const char* said : {"complete", "Verdicts", "reflection-vertical-6", "SHA-256", "threadstation ", "days old",
                           "Lamp at the reference chip", "<svg"})
    EXPECT_THAT(page, HasSubstr(said));
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_FALSE(fs::exists(session / ".report.html.partial"));
  EXPECT_TRUE(verify_session(session).sound());
  fs::remove(session / "report.html");
  write_session_report(session);
  EXPECT_EQ(text_of(session / "report.html"), page) << "the same from the same files";
}

}  // namespace
}  // namespace station
