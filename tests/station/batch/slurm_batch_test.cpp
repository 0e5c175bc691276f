// Batches that a real Slurm does, while everything about it is killed.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <random>
#include <thread>

#include "station/documents/disk/sha256.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/batch/slurm_here.h"
#include "tests/station/batch/small_sessions.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

// A fit of a second, and tables of what it found.
const json kSteps{{{"do", "invert"}, {"options", {"--paths", "256", "--spp", "64"}}, {"memory_gib", 0.4}},
                  {{"do", "export"}, {"options", {"--only", "csv"}}, {"memory_gib", 0.3}}};

class SlurmBatchTest : public ::testing::Test {
 protected:
  void begin(int sessions) {
    make_sessions(folder_.path(), sessions, true);
    plan_ = written_plan(folder_.path(), kSteps);
    out_ = folder_ / "batch";
    fs::create_directory(folder_ / "slurm");
    slurm_ = std::make_unique<SlurmHere>(folder_ / "slurm");
  }
  ProgramResult submit() { return run_threadstation({"batch", plan_, "--out", out_, "--on", "slurm", "--json"}); }
  json status() { return json::parse(run_threadstation({"batch", "status", out_, "--json"}).out); }
  static int count(const json& description, const std::string& state) {
    int sum = 0;
    for (const json& step : description.at("steps")) sum += step.at(state).get<int>();
    return sum;
  }
  // Files of this name in the folders of the tasks: those that have ended, or that run.
  int count_files(const std::string& name) {
    int files = 0;
    std::error_code none;  // folders come while they are looked through
    for (fs::recursive_directory_iterator at(fs::path(out_) / "tasks", none), end; !none && at != end;
         at.increment(none))
      files += at->path().filename() == name;
    return files;
  }
  // Until so many tasks have ended, and so many have begun that have not.
  void wait_until_ended(int wanted, int begun = 2) {
    const auto so_far = [&] { return count_files("record.json") >= wanted && count_files("begun.json") >= begun; };
    bool come = so_far();
    for (int i = 0; i < 2400 && !come; ++i, come = so_far()) sleep_s(0.05);
    EXPECT_TRUE(come) << what_is_wrong();
  }
  std::string what_is_wrong() {
    return SlurmHere::said("sinfo --list-reasons; squeue; tail -n 3 " + (folder_ / "slurm").string() + "/*.log; " +
                           THREADSTATION_PROGRAM + " batch status " + out_);
  }
  // Submits what is left until all is done, five times at most.
  void finish(int tasks) {
    for (int i = 0; i < 5 && count(status(), "done") < tasks; ++i) {
      const ProgramResult again = submit();
      ASSERT_EQ(again.status, 0) << again.error;
      ASSERT_TRUE(slurm_->wait_until_empty(400)) << SlurmHere::said("squeue; sinfo");
    }
    EXPECT_EQ(count(status(), "done"), tasks) << what_is_wrong();
  }
  // What the same plan makes of the same sessions on this computer.
  std::map<std::string, std::string> made_here(int sessions) {
    const TemporaryFolder here;
    make_sessions(here.path(), sessions, true);
    const std::string plan = written_plan(here.path(), kSteps);
    const ProgramResult local = run_threadstation({"batch", plan, "--out", here / "batch", "--quiet"});
    EXPECT_EQ(local.status, 0) << local.error;
    return made_in(here.path());
  }
  TemporaryFolder folder_;
  std::string plan_, out_;
  std::unique_ptr<SlurmHere> slurm_;
};

// Arrays of fifty fits: the process that submits them is killed three times, one of the nodes loses its power, tasks
// are killed, and others give way to a job of a higher partition.
TEST_F(SlurmBatchTest, FiftyFitsSurviveKillsAndEndWithWhatThisComputerMakes) {
  constexpr int kSessions = 50;
  begin(kSessions);
  constexpr unsigned kSeed = 20261130;
  std::mt19937 random(kSeed);
  std::printf("seed %u\n", kSeed);
  for (int i = 0; i < 3; ++i) {
    const pid_t process = start_threadstation({"batch", plan_, "--out", out_, "--on", "slurm"});
    sleep_s(std::uniform_real_distribution<>(0.02, 0.25)(random));
    ::kill(process, SIGKILL);
    wait_for(process);
  }
  const ProgramResult submitted = submit();
  ASSERT_EQ(submitted.status, 0) << submitted.error;
  EXPECT_LE(SlurmHere::queued(), 2 * kSessions) << "nothing is submitted twice";

  int seen_running = 0, dead = 0;  // dead: that have begun and will not end
  int disturbances = 0;
  const auto disturb = [&](int ended, const std::function<void()>& action) {
    wait_until_ended(ended, dead + 2);
    seen_running += SlurmHere::running();
    ++disturbances;
    action();
    dead = count_files("begun.json");
  };
  disturb(4, [&] { SlurmHere::said("pkill -KILL -f 'batch task " + out_ + "'"); });
  disturb(12, [&] {
    slurm_->kill_node(2);
    sleep_s(7);  // until the controller gives it up
    slurm_->start_node(2);
  });
  disturb(30, [] { SlurmHere::said("srun --partition=high --nodes=2 --exclusive --time=1 sleep 1"); });
  EXPECT_GT(seen_running, 3) << "the fits have ended too soon for this test";
  ASSERT_TRUE(slurm_->wait_until_empty(400)) << SlurmHere::said("squeue; sinfo");
  std::printf("after the kills: %d of %d tasks done, %d had been running\n", count(status(), "done"), 2 * kSessions,
              seen_running);
  finish(2 * kSessions);

  EXPECT_TRUE(made_in(folder_.path()) == made_here(kSessions));
  int attempts = 0;
  for (int i = 0; i < kSessions; ++i)
    for (const char* step : {"invert", "export"}) {
      const std::string item = "s" + std::string(i < 10 ? "0" : "") + std::to_string(i);
      attempts += record_in(folder_.path(), step, item).at("attempts").get<int>();
    }
  // No more than both nodes have cores, each time.
  EXPECT_LE(attempts, 2 * kSessions + 2 * SlurmHere::kCores * disturbances)
      << "nothing was computed twice but what was lost";
  std::printf("%d attempts for %d tasks\n", attempts, 2 * kSessions);
}

TEST_F(SlurmBatchTest, AFullDiskLosesNothing) {
  if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0)
    GTEST_SKIP() << "this system lets its users have no disks of their own (unshare --mount)";
  const fs::path disk = folder_ / "batch";
  fs::create_directory(disk);
  ASSERT_EQ(::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=200m"), 0);
  constexpr int kSessions = 8;
  begin(kSessions);
  ASSERT_EQ(submit().status, 0);
  wait_until_ended(1);
  SlurmHere::said("cat /dev/zero > " + (disk / "fill").string());
  ASSERT_TRUE(slurm_->wait_until_empty(200));
  const json full = status();
  EXPECT_LT(count(full, "done"), 2 * kSessions) << "the disk was to be full before the end";

  const ProgramResult refused = submit();
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.error.find("No space left on device; free space on that disk, then go on"), std::string::npos)
      << refused.error;
  fs::remove(disk / "fill");
  finish(2 * kSessions);
  EXPECT_TRUE(made_in(folder_.path()) == made_here(kSessions));
  slurm_.reset();
  ::umount2(disk.c_str(), MNT_DETACH);
}

TEST_F(SlurmBatchTest, WhatWasTakenBackOrCancelledIsToldOfAndDoneLater) {
  constexpr int kSessions = 40;  // more than this Slurm's arrays have indices
  begin(kSessions);
  const ProgramResult submitted = submit();
  ASSERT_EQ(submitted.status, 0) << submitted.error;
  EXPECT_EQ(json::parse(submitted.out).at("steps")[0].at("tasks"), kSessions);
  EXPECT_EQ(submit().status, 0);
  EXPECT_LE(SlurmHere::queued(), 2 * kSessions);
  wait_until_ended(3);
  SlurmHere::said("pkill -KILL -f 'batch tas[k] " + out_ + "'");
  wait_until_ended(4, count_files("begun.json") + 1);  // of the dead, and one that runs
  const ProgramResult cancelled = run_threadstation({"batch", "cancel", out_});
  EXPECT_EQ(cancelled.status, 0) << cancelled.error;
  EXPECT_NE(cancelled.out.find("taken back from Slurm: "), std::string::npos) << cancelled.out;
  ASSERT_TRUE(slurm_->wait_until_empty(60));
  // The command of the killed task is nobody's now (this Slurm tracks processes by their parents) and ends by itself;
  // Slurm's list of completed jobs is written a moment after its queue is empty.
  json description = status();
  const auto is_told = [&] { return description.dump().find("Slurm ended it as ") != std::string::npos; };
  for (int i = 0; i < 100 && (count(description, "running") > 0 || !is_told()); ++i) {
    sleep_s(0.5);
    description = status();
  }
  EXPECT_GT(count(description, "done"), 0);
  EXPECT_EQ(count(description, "queued") + count(description, "running"), 0);
  EXPECT_TRUE(is_told()) << what_is_wrong();
  EXPECT_EQ(run_threadstation({"batch", "cancel", out_}).out, "nothing of it is running\n");
  // That somebody took tasks back does not double what they are given from now on.
  SlurmHere::said("scontrol update partitionname=low state=DOWN");  // so that none of them begins again
  EXPECT_EQ(submit().status, 0);
  int stopped = 0;
  for (int i = 0; i < kSessions; ++i) {
    const fs::path begun =
        fs::path(out_) / "tasks/invert" / ("s" + std::string(i < 10 ? "0" : "") + std::to_string(i)) / "begun.json";
    stopped += fs::exists(begun) && station::read_json_file(begun).value("stopped", false);
  }
  EXPECT_GT(stopped, 0);
  EXPECT_EQ(run_threadstation({"batch", "cancel", out_}).status, 0);
  ASSERT_TRUE(slurm_->wait_until_empty(60));
  for (int i = 0; i < 100 && count(status(), "running") > 0; ++i) sleep_s(0.5);
  const ProgramResult local = run_threadstation({"batch", plan_, "--out", out_, "--quiet"});
  EXPECT_EQ(local.status, 0) << "here goes on where Slurm has ended: " << local.error;
  EXPECT_EQ(count(status(), "done"), 2 * kSessions);
}

TEST_F(SlurmBatchTest, SrunsProcessesDrawOnePictureTogether) {
  begin(1);
  const std::string render = std::string(THREADSTATION_PROGRAM) + " render plain_swatch --spp 2 --quiet --out ";
  ASSERT_EQ(run_shell(render + (folder_ / "one.exr").string()).status, 0);
  // Two nodes of one computer cannot have processes of one PMIx, whose sockets would have the same names.
  for (const int ranks : {2, 4}) {
    const ProgramResult result =
        run_shell("srun --mpi=pmix --nodes=1 --overcommit --mem=500 -n " + std::to_string(ranks) + " " + render +
                  (folder_ / "many.exr").string() + " --fresh");
    ASSERT_EQ(result.status, 0) << result.error;
    EXPECT_EQ(station::sha256_of_file(folder_ / "many.exr"), station::sha256_of_file(folder_ / "one.exr")) << ranks;
  }
}

}  // namespace
}  // namespace station_test
