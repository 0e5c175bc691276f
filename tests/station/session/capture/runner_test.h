// A test fixture with a session on fake devices, for tests of the runner.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/session/record/verify.h"
#include "tests/station/session/capture/fakes.h"

namespace station {

class RunnerTest : public testing::Test {
 protected:
  std::string last_outcome() const {
    const JournalRecord last = records_of(path).back();
    return last.event == "stop" ? last.data.at("outcome").get<std::string>() : last.event;
  }

  // Resumes the session on fresh devices, as after a new start of the program, and expects it to be complete.
  void expect_resume_completes(const Plan& plan) const {
    FakeStation fresh;
    EXPECT_EQ(fresh.run(path, plan), RunState::complete);
    const VerifyReport report = verify_session(path);
    EXPECT_THAT(report.problems, testing::IsEmpty());
    EXPECT_TRUE(report.complete);
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder / "session";
  FakeStation fake;
};

}  // namespace station
