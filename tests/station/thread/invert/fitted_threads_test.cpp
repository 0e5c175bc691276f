// From a spool to its thread, by the commands: the fitted thread's views against those of the bundle of fibers that the
// simulated bench photographed.

#include <cmath>
#include <filesystem>

#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "tests/station/commands/workflow.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class FittedThreads : public Workflow {
 protected:
  // A session of the spool, drawn with `samples` rays a pixel, developed.
  static std::string developed_session(const std::string& spool, int samples) {
    json rig = station::read_json_file(path("rig.json"));
    rig["simulation"]["samples_per_pixel"] = samples;
    station::write_json_file(path("fine_rig.json"), rig);
    const std::string session = path(spool + std::to_string(samples));
    expect_success(run_threadstation(capture_arguments(session, "fine_rig.json", spool)));
    expect_success(run_threadstation({"develop", session, "--quiet"}));
    return session;
  }
  static json invert(const std::string& session, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"invert", session, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_threadstation(arguments);
    expect_success(result);
    return json::parse(result.out);
  }
};

TEST_F(FittedThreads, ViewsOfThreeSpoolsAgreeWithinFifteenPercentAndWorseWithAnyGroupHeld) {
  for (const std::string spool : {"cotton_white", "polyester_dark", "silk_blue"}) {
    const std::string session = developed_session(spool, 12);
    const double free = invert(session, {"--paths", "256", "512", "--spp", "8"}).at("relative_rmse");
    RecordProperty(spool, std::to_string(free));
    std::printf("%s: relative RMSE %.1f %%\n", spool.c_str(), 100 * free);
    EXPECT_LT(free, 0.15) << spool;
    if (spool != "silk_blue") continue;
    for (const std::string group : {"sigma_a", "alpha", "beta", "r"}) {
      const double held = invert(session, {"--hold", group, "--paths", "128", "256", "--spp", "4"}).at("relative_rmse");
      std::printf("  %s held at its start: %.1f %%\n", group.c_str(), 100 * held);
      EXPECT_GT(held, 1.4 * free) << group;
    }
  }
}

TEST_F(FittedThreads, InvertLeavesAThreadFittedViewsAndResidualsThatTheReportShows) {
  const std::string session = path("session");
  const std::string copy = path("copy.json");
  const json said = invert(session, {"--paths", "16", "--spp", "2", "--out", copy});
  const station::ThreadFile thread = station::read_thread(said.at("thread").get<std::string>());
  EXPECT_EQ(thread.name, "silk, red");
  EXPECT_EQ(thread.provenance.at("session"), "session");
  EXPECT_EQ(thread.fit.at("views").size(), 17U);
  EXPECT_EQ(station::read_json_file(copy), station::to_json(thread));
  for (const char* folder : {"fitted", "residual"})
    EXPECT_TRUE(fs::exists(session + "/result/" + folder + "/transmission-5.exr"));
  expect_success(run_threadstation({"report", session}));
  const std::string page = run_shell("cat '" + session + "/report.html'").out;
  for (const char* part : {"relative RMSE", "<svg", "Photographs and their fitted twins"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  expect_success(run_threadstation({"verify", session}));
}

TEST_F(FittedThreads, WrongInputsOfTheFitGetOneLine) {
  const std::string session = path("copied");
  fs::copy(path("session"), session, fs::copy_options::recursive);
  fs::remove_all(session + "/result");
  for (const std::string& out : {path("nowhere/thread.json"), path("session")})
    expect_one_line(run_threadstation({"invert", session, "--quiet", "--out", out}), out);
  EXPECT_FALSE(fs::exists(session + "/result")) << "the fit begins only when its thread can be written";
  fs::remove_all(session + "/linear");
  expect_one_line(run_threadstation({"invert", session, "--quiet"}), "views.json");
  expect_one_line(run_threadstation({"invert", path("nowhere"), "--quiet"}), "nowhere");
  const ProgramResult wrong = run_threadstation({"invert", session, "--hold", "colour"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_EQ(wrong.error_lines(), 1) << wrong.error;
}

}  // namespace
}  // namespace station_test
