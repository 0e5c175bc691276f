// Sessions whose process or disk is taken away at every moment: nothing may be lost, doubled or half there.
//
// The process under test is a fork of this one; FakeFileSystem ends it at a chosen call, or a timer at any instant.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <random>

#include "station/session/record/verify.h"
#include "tests/station/session/capture/fakes.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Trouble = FakeFileSystem::Trouble;

void kill_me(int) {
  ::raise(SIGKILL);
}

void kill_me_after(std::chrono::microseconds delay) {
  ::signal(SIGALRM, &kill_me);
  itimerval timer{};
  timer.it_value.tv_sec = delay.count() / 1000000;
  timer.it_value.tv_usec = delay.count() % 1000000;
  ::setitimer(ITIMER_REAL, &timer, nullptr);
}

// Runs or resumes a session in a process of its own; `prepare` sets its trouble. True: it was killed.
bool run_in_child(const fs::path& session, const Plan& plan, const std::function<void(FakeStation&)>& prepare) {
  const pid_t child = ::fork();
  if (child == 0) {
    FakeStation fake;
    prepare(fake);
    const std::string message = message_of([&] { fake.run(session, plan); });
    if (!message.empty()) ::write(STDERR_FILENO, (message + "\n").data(), message.size() + 1);
    ::_exit(message.empty() ? 0 : 1);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
  EXPECT_TRUE(killed || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) << "status " << status;
  return killed;
}

std::map<std::string, PictureRecord> journalled_pictures(const fs::path& session) {
  return fs::exists(session / "journal.jsonl") ? pictures_of(session) : std::map<std::string, PictureRecord>();
}

void expect_kept(const std::map<std::string, PictureRecord>& before, const fs::path& session) {
  const auto after = pictures_of(session);
  for (const auto& [step, picture] : before) {
    ASSERT_TRUE(after.contains(step)) << step;
    EXPECT_EQ(after.at(step).sha256, picture.sha256) << step;
  }
}

void expect_whole(const fs::path& session, const Plan& plan) {
  const VerifyReport report = verify_session(session);
  EXPECT_THAT(report.problems, testing::IsEmpty());
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.views, view_count(plan));
  EXPECT_EQ(count_events(session, "picture"), plan.steps.size()) << "a step was journalled twice";
}

void resume_and_expect_whole(const fs::path& session, const Plan& plan) {
  const auto before = journalled_pictures(session);
  EXPECT_FALSE(run_in_child(session, plan, [](FakeStation&) {}));
  expect_kept(before, session);
  expect_whole(session, plan);
}

void sweep_kills(const TemporaryFolder& folder, bool volatile_cache) {
  const Plan plan = small_plan();
  int call = 1;
  for (bool killed = true; killed; ++call) {
    SCOPED_TRACE("killed at call " + std::to_string(call));
    const fs::path session = folder.session(call);
    killed = run_in_child(session, plan, [&](FakeStation& fake) {
      fake.disk.trouble = Trouble::kill;
      fake.disk.at_call = call;
      fake.disk.volatile_cache = volatile_cache;
    });
    resume_and_expect_whole(session, plan);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(call, 60) << "there is more than that to be written";
}

TEST(Interruption, KilledAtEveryCallOfTheDiskASessionResumesWhole) {
  sweep_kills(TemporaryFolder(), false);
}

TEST(Interruption, WhenThePowerGoesAtEveryCallOfTheDiskASessionResumesWhole) {
  sweep_kills(TemporaryFolder(), true);
}

TEST(Interruption, KilledAgainAndAgainWhileResumingASessionEndsWhole) {
  const TemporaryFolder folder;
  const Plan plan = small_plan();
  const fs::path session = folder / "session";
  // Each process gets one call further than the one before it, so that some step is always reached.
  int call = 1;
  std::map<std::string, PictureRecord> before;
  while (run_in_child(session, plan, [&](FakeStation& fake) {
    fake.disk.trouble = Trouble::kill;
    fake.disk.at_call = call;
  })) {
    if (!before.empty()) expect_kept(before, session);
    before = journalled_pictures(session);
    ++call;
  }
  expect_whole(session, plan);
}

TEST(Interruption, KilledAtRandomMomentsASessionResumesWhole) {
  const TemporaryFolder folder;
  const Plan plan = make_capture_plan({});
  const auto began = std::chrono::steady_clock::now();
  ASSERT_FALSE(run_in_child(folder / "measured", plan, [](FakeStation&) {}));
  const auto whole = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - began);
  std::mt19937 random(7);
  std::uniform_int_distribution<long> delay(1, whole.count());
  int kills = 0;
  for (int number = 0; kills < 200 && number < 3000; ++number) {
    const fs::path session = folder.session(number);
    const std::chrono::microseconds moment(delay(random));
    kills += run_in_child(session, plan, [&](FakeStation&) { kill_me_after(moment); }) ? 1 : 0;
    resume_and_expect_whole(session, plan);
    ASSERT_FALSE(testing::Test::HasFailure()) << "killed after " << moment.count() << " us";
    fs::remove_all(session);
  }
  EXPECT_EQ(kills, 200);
}

void sweep_failures(int error, Trouble trouble, const std::string& system_says) {
  const TemporaryFolder folder;
  const Plan plan = small_plan();
  std::string message = "not run yet";
  for (int call = 1; !message.empty(); ++call) {
    SCOPED_TRACE("failed at call " + std::to_string(call));
    const fs::path session = folder.session(call);
    FakeStation fake;
    fake.disk.trouble = trouble;
    fake.disk.at_call = call;
    fake.disk.error = error;
    message = message_of([&] { fake.run(session, plan); });
    if (!message.empty()) {
      EXPECT_THAT(message, HasSubstr(system_says));
      EXPECT_THAT(message, HasSubstr("could not write '" + session.string()));
      EXPECT_EQ(message.find('\n'), std::string::npos) << "one line";
    }
    resume_and_expect_whole(session, plan);
    ASSERT_FALSE(testing::Test::HasFailure());
  }
}

TEST(Interruption, AFullDiskAtEveryCallIsOneClearLineAndTheSessionResumesWhole) {
  sweep_failures(ENOSPC, Trouble::fail_from_then_on, "No space left on device; free space");
}

TEST(Interruption, AWriteThatFailsOnceAtEveryCallIsOneClearLineAndTheSessionResumesWhole) {
  sweep_failures(EIO, Trouble::fail_once, "Input/output error; the disk or its cable");
}

TEST(Interruption, AReadOnlyDiskAtEveryCallIsOneClearLineAndTheSessionResumesWhole) {
  sweep_failures(EROFS, Trouble::fail_from_then_on, "Read-only file system; make that disk writable");
}

}  // namespace
}  // namespace station
