// Whole sessions of 17 views with all checks, killed at every step and at 200 random moments, each then resumed and
// verified. The pictures are those of the recorded session: nothing is drawn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <iostream>
#include <random>

#include "station/session/replay/played_devices.h"
#include "station/session/run_session.h"
#include "tests/station/session/recorded_bench.h"

namespace station {
namespace {

namespace fs = std::filesystem;

void kill_me(int) {
  ::raise(SIGKILL);
}

struct KilledSession : testing::Test {
  KilledSession()
      : asked(read_session_file(recorded_session())),
        calibration(read_calibration(recorded_session() / "calibration")),
        runs(read_device_log(recorded_session())),
        pictures(recorded_pictures(recorded_session())) {}

  void take(const fs::path& session_folder, const std::function<void(const Progress&)>& progress) const {
    StandIns played = play_freely(runs, pictures);
    rig::SimulatedClock clock(1.8e9);
    FileSystem disk;
    SessionFolder session =
        is_session(session_folder)
            ? SessionFolder::open(session_folder, clock, disk)
            : SessionFolder::create(session_folder, nlohmann::json::parse(text_of(recorded_session() / "session.json")),
                                    {{"calibration.json", calibration_bytes()}}, clock, disk);
    run_session(session, {*played.camera, *played.turntable, *played.person, clock}, asked, calibration, {},
                {.progress = progress});
  }

  static std::vector<std::byte> calibration_bytes() {
    const std::string text = text_of(recorded_session() / "calibration/calibration.json");
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    return {bytes, bytes + text.size()};
  }

  // In a process of its own. True: it was killed.
  bool run_in_child(const fs::path& session, const std::function<void()>& prepare,
                    const std::function<void(const Progress&)>& progress = {}) const {
    const pid_t child = ::fork();
    if (child == 0) {
      prepare();
      const std::string message = message_of([&] { take(session, progress); });
      if (!message.empty()) ::write(STDERR_FILENO, (message + "\n").data(), message.size() + 1);
      ::_exit(message.empty() ? 0 : 1);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    EXPECT_TRUE(killed || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) << "status " << status;
    return killed;
  }

  void resume_and_expect_whole(const fs::path& session) const {
    const auto before =
        fs::exists(session / "journal.jsonl") ? pictures_of(session) : std::map<std::string, PictureRecord>();
    EXPECT_FALSE(run_in_child(session, [] {}));
    const VerifyReport report = verify_session(session);
    EXPECT_THAT(report.problems, testing::IsEmpty());
    EXPECT_TRUE(report.complete);
    EXPECT_EQ(report.views, 17U);
    const auto after = pictures_of(session);
    for (const auto& [step, picture] : before) EXPECT_EQ(after.at(step).sha256, picture.sha256) << step;
    EXPECT_EQ(count_events(session, "picture"), asked.plan.steps.size()) << "no step was journalled twice";
    EXPECT_LE(count_events(session, "discarded"), 1U) << "at most one picture was taken again";
    for (const auto& entry : fs::directory_iterator(session / "raw")) EXPECT_EQ(entry.path().extension(), ".arw");
  }

  TemporaryFolder folder;
  SessionFile asked;
  RigCalibration calibration;
  std::vector<RecordedRun> runs;
  std::map<std::string, fs::path> pictures;
};

TEST_F(KilledSession, AtTheBeginningOfEveryStepResumesWhole) {
  int step = 0;
  for (bool killed = true; killed;) {
    ++step;
    SCOPED_TRACE("killed at step " + std::to_string(step));
    int seen = 0;
    killed = run_in_child(
        folder.session(step), [] {},
        [&](const Progress&) {
          if (++seen == step) ::raise(SIGKILL);
        });
    resume_and_expect_whole(folder.session(step));
    fs::remove_all(folder.session(step));
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(step, static_cast<int>(asked.plan.steps.size()));
  std::cout << step - 1 << " steps killed at, each resumed and verified\n";
}

TEST_F(KilledSession, AtTwoHundredRandomMomentsResumesWhole) {
  const auto began = std::chrono::steady_clock::now();
  ASSERT_FALSE(run_in_child(folder / "measured", [] {}));
  const auto whole = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - began);
  constexpr unsigned kSeed = 20261121;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<long> delay(1, whole.count());
  int kills = 0, began_again = 0;
  for (int number = 0; kills < 200 && number < 2000; ++number) {
    const fs::path session = folder.session(number);
    const long moment_us = delay(random);
    kills += run_in_child(session,
                          [moment_us] {
                            ::signal(SIGALRM, &kill_me);
                            itimerval timer{};
                            timer.it_value.tv_sec = moment_us / 1000000;
                            timer.it_value.tv_usec = moment_us % 1000000;
                            ::setitimer(ITIMER_REAL, &timer, nullptr);
                          })
                 ? 1
                 : 0;
    began_again += is_session(session) ? 0 : 1;
    resume_and_expect_whole(session);
    fs::remove_all(session);
    ASSERT_FALSE(HasFailure()) << "killed after " << moment_us << " us";
  }
  EXPECT_EQ(kills, 200);
  std::cout << kills << " kills (seed " << kSeed << "), " << began_again << " of them before the session was there\n";
}

}  // namespace
}  // namespace station
