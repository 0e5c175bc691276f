// One picture by several processes, as mpirun starts them.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "station/documents/disk/sha256.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/cloth/render/small_scene.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Root may, and more processes than cores; each does as on a computer of its own.
const std::string kRun =
    "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 exec mpirun --oversubscribe --mca btl self,vader -n ";

class RenderRanksTest : public ::testing::Test {
 protected:
  void SetUp() override {
    json scene = small_scene("plain_swatch");
    scene["samples_per_pixel"] = 128;
    station::write_json_file(folder_ / "scene.json", scene);
  }
  std::string command(const std::string& out, const std::string& more = {}) {
    return std::string(THREADSTATION_PROGRAM) + " render " + (folder_ / "scene.json").string() + " --out " +
           (folder_ / out).string() + " " + more;
  }
  ProgramResult by(int ranks, const std::string& out, const std::string& more = {}) {
    return run_shell(kRun + std::to_string(ranks) + " " + command(out, more));
  }
  std::string hash(const std::string& name) { return station::sha256_of_file(folder_ / name); }
  int parts_of(const std::string& out) {
    int parts = 0;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      parts += entry.path().filename().string().starts_with(out + ".checkpoint.");
    return parts;
  }
  // Ranks that draw `out` with a checkpoint ten times a second, from when all have stored their part.
  pid_t started(int ranks, const std::string& out, const std::string& more) {
    const std::string line = kRun + std::to_string(ranks) + " " + command(out, "--checkpoint-every 0.1 " + more) +
                             " > /dev/null 2> " + (folder_ / "said").string();
    const pid_t mpirun = ::fork();
    if (mpirun == 0) {
      ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      ::_exit(127);
    }
    for (int i = 0; i < 6000 && parts_of(out) < ranks; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(parts_of(out), ranks);
    return mpirun;
  }
  std::string said() {
    std::ifstream stream(folder_ / "said");
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  TemporaryFolder folder_;
};

TEST_F(RenderRanksTest, OneTwoAndFourProcessesDrawTheSamePictureBitForBit) {
  for (const std::string how : {"", "--noise 20%"}) {
    ASSERT_EQ(run_shell(command("one.exr", "--fresh " + how)).status, 0);
    for (const int ranks : {1, 2, 4}) {
      const ProgramResult result = by(ranks, "many.exr", "--fresh --json " + how);
      ASSERT_EQ(result.status, 0) << result.error;
      EXPECT_EQ(hash("many.exr"), hash("one.exr")) << ranks << " " << how;
      const json report = json::parse(result.out);  // of the first alone
      if (how.empty()) EXPECT_EQ(report.at("samples"), 40 * 40 * 128) << "of all processes";
      EXPECT_EQ(parts_of("many.exr"), 0);
    }
  }
}

TEST_F(RenderRanksTest, AProcessThatDiesCostsItsTilesAlone) {
  const std::string most = "--spp 512";
  ASSERT_EQ(run_shell(command("whole.exr", most)).status, 0);
  const pid_t mpirun = started(4, "a.exr", most);
  // The second of them, as the kernel does it where memory ends.
  const ProgramResult killed = run_shell("kill -KILL $(pgrep -P " + std::to_string(mpirun) + " | sed -n 2p)");
  EXPECT_EQ(killed.status, 0) << killed.error;
  EXPECT_NE(wait_for(mpirun), 0);
  EXPECT_FALSE(fs::exists(folder_ / "a.exr"));
  EXPECT_EQ(parts_of("a.exr"), 4);
  ASSERT_TRUE(fs::remove(folder_ / "a.exr.checkpoint.2of4")) << "as if it had never stored anything";
  const ProgramResult again = by(3, "a.exr", most + " --json");
  ASSERT_EQ(again.status, 0) << again.error;
  const json report = json::parse(again.out);
  EXPECT_GT(report.at("samples_before").get<int>(), 0);
  EXPECT_EQ(report.at("samples").get<int>() + report.at("samples_before").get<int>(), 40 * 40 * 512);
  EXPECT_EQ(hash("a.exr"), hash("whole.exr"));
  EXPECT_EQ(parts_of("a.exr"), 0);
}

TEST_F(RenderRanksTest, CtrlCLeavesAllPartsAndOneLineAndOneProcessGoesOn) {
  const std::string most = "--spp 512";
  ASSERT_EQ(run_shell(command("whole.exr", most)).status, 0);
  const pid_t mpirun = started(2, "a.exr", most);
  for (int i = 1; i <= 2; ++i)
    EXPECT_EQ(
        run_shell("kill -INT $(pgrep -P " + std::to_string(mpirun) + " | sed -n " + std::to_string(i) + "p)").status,
        0);
  EXPECT_NE(wait_for(mpirun), 0);
  const std::string error = said();
  std::size_t lines = 0;
  for (std::size_t at = 0; (at = error.find("threadstation: ", at)) != std::string::npos; ++at) ++lines;
  EXPECT_EQ(lines, 1u) << error;
  EXPECT_NE(error.find("the same command goes on with it"), std::string::npos) << error;
  EXPECT_EQ(parts_of("a.exr"), 2);
  const ProgramResult again = run_shell(command("a.exr", most + " --json"));
  ASSERT_EQ(again.status, 0) << again.error;
  EXPECT_GT(json::parse(again.out).at("samples_before").get<int>(), 0);
  EXPECT_EQ(hash("a.exr"), hash("whole.exr"));
  EXPECT_EQ(parts_of("a.exr"), 0);
}

TEST_F(RenderRanksTest, BadInputAndAFolderOfSeveralScenesAreOneMatter) {
  const ProgramResult bad = by(2, "no/such/a.exr");
  EXPECT_NE(bad.status, 0);
  EXPECT_NE(bad.error.find("there is no folder"), std::string::npos) << bad.error;
  const std::string folder = folder_ / "pictures", second = folder_ / "second.json";
  fs::copy_file(folder_ / "scene.json", second);
  const auto both = [&] {
    return run_shell(kRun + "2 " + THREADSTATION_PROGRAM + " render " + (folder_ / "scene.json").string() + " " +
                     second + " --spp 2 --json --out " + folder);
  };
  const ProgramResult made = both(), kept = both();
  ASSERT_EQ(made.status, 0) << made.error;
  EXPECT_EQ(json::parse(made.out).size(), 2u);
  EXPECT_EQ(hash("pictures/scene.exr"), hash("pictures/second.exr"));
  ASSERT_EQ(kept.status, 0) << kept.error;
  EXPECT_TRUE(json::parse(kept.out)[1].at("kept"));
}

TEST_F(RenderRanksTest, ProcessesOfSrunThatCannotTalkToEachOtherAreRefused) {
  const ProgramResult result = run_shell("SLURM_STEP_NUM_TASKS=4 SLURM_PROCID=1 " + command("a.exr"));
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.error.find("srun started 4 processes that cannot talk to each other; give it --mpi=pmix"),
            std::string::npos)
      << result.error;
}

}  // namespace
}  // namespace station_test
