// threadstation scatter simulate, fit and plot, as a person types them.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "station/documents/number_table.h"
#include "station/documents/reader.h"
#include "station/thread/scatter/distribution_file.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;

class ScatterSimulate : public testing::Test {
 protected:
  ProgramResult simulate(const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> arguments{"scatter", "simulate", "--rays",  "500",   "--configurations", "20",
                                       "--bins",  "60",       "--quiet", "--out", (folder_ / name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_threadstation(arguments);
  }
  ProgramResult fit(const std::vector<std::string>& names) const {
    std::vector<std::string> arguments{"scatter", "fit", "--out", folder_ / "fit.json", "--in"};
    for (const std::string& name : names) arguments.push_back(folder_ / name);
    return run_threadstation(arguments);
  }
  static void expect_refusal(const ProgramResult& result, const std::string& must_say) {
    EXPECT_EQ(result.status, 1) << result.error;
    EXPECT_NE(result.error.find(must_say), std::string::npos) << result.error;
    const std::size_t at = result.error.rfind("threadstation: ");  // progress may stand above
    ASSERT_NE(at, std::string::npos) << result.error;
    EXPECT_EQ(result.error.find('\n', at), result.error.size() - 1) << result.error;
  }
  TemporaryFolder folder_;
};

TEST_F(ScatterSimulate, WritesADensityThatIntegratesToTheAlbedoItStates) {
  ASSERT_EQ(simulate("dark.csv", {"--absorption", "0.1", "--theta", "30"}).status, 0);
  const station::NumberTable table(folder_ / "dark.csv", {"phi_rad", "density"}, {});
  ASSERT_EQ(table.rows(), 60U);
  double sum = 0;
  for (std::size_t i = 0; i < table.rows(); ++i) sum += table.number(i, "density", {0, 10});
  EXPECT_NEAR(sum * 2 * std::numbers::pi / 60, table.note("albedo", {0, 1}), 1e-9);
  EXPECT_NEAR(table.number(0, "phi_rad", {-4, 4}), -std::numbers::pi + std::numbers::pi / 60, 1e-12);
  EXPECT_GT(table.note("missed", {0, 1}), 0.01);
  const station::Distribution read = station::read_distribution(folder_ / "dark.csv");
  EXPECT_NEAR(read.data.theta_rad, std::numbers::pi / 6, 1e-12);
  EXPECT_EQ(read.data.absorption, 0.1);
  EXPECT_EQ(read.radius_ratio, 0.1);
}

TEST_F(ScatterSimulate, TheSameSeedGivesTheSameFileWhateverTheThreads) {
  ASSERT_EQ(simulate("one.csv", {"--threads", "1"}).status, 0);
  ASSERT_EQ(simulate("two.csv", {"--threads", "2"}).status, 0);
  EXPECT_EQ(
      run_shell("cmp '" + std::string(folder_ / "one.csv") + "' '" + std::string(folder_ / "two.csv") + "'").status, 0);
}

TEST_F(ScatterSimulate, RefusesThreadsThatCannotBe) {
  expect_refusal(simulate("x.csv", {"--fiber-radius", "11"}), "does not fit");
  expect_refusal(simulate("x.csv", {"--theta", "90"}), "theta");
  expect_refusal(simulate("x.csv", {"--eta", "0.9"}), "refraction");
  expect_refusal(simulate("no/such/folder/x.csv", {}), "x.csv");
  EXPECT_EQ(simulate("x.csv", {"--rays", "many"}).status, 2);
  EXPECT_FALSE(fs::exists(folder_ / "x.csv"));
}

TEST_F(ScatterSimulate, FitsEachAngleAndJointlyAndSaysWhatItFound) {
  for (const char* theta : {"0", "45", "70"})
    for (const char* absorption : {"0", "0.1"})
      ASSERT_EQ(
          simulate(std::string("t") + theta + "a" + absorption + ".csv", {"--theta", theta, "--absorption", absorption})
              .status,
          0);
  const ProgramResult result = fit({"t0a0.csv", "t45a0.csv", "t70a0.csv", "t0a0.1.csv", "t45a0.1.csv", "t70a0.1.csv"});
  ASSERT_EQ(result.status, 0) << result.error;
  EXPECT_NE(result.out.find("yarn reconstruction"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("jointly over 2 absorptions"), std::string::npos) << result.out;
  const nlohmann::json found = station::read_json_file(folder_ / "fit.json");
  ASSERT_EQ(found["separate"].size(), 6U);
  ASSERT_EQ(found["joint"].size(), 2U);
  for (const nlohmann::json& one : found["separate"]) {
    EXPECT_LT(one["thread"]["relative_l2_error"], 0.2) << one;
    EXPECT_LT(one["thread"]["relative_l2_error"], one["yarn"]["relative_l2_error"]) << "the thread model fits better";
  }
  const nlohmann::json& all = found["joint_over_absorptions"];
  EXPECT_EQ(all["thread"]["sigma_a_per_thread_radius"][0], 0);
  EXPECT_GT(all["thread"]["sigma_a_per_thread_radius"][1], 0.1);
  EXPECT_EQ(all["thread"]["unknowns"].size(), 11U);
  EXPECT_EQ(all["thread"]["parameters"]["r0"].size(), 3U);
}

TEST_F(ScatterSimulate, FitRefusesFilesThatDoNotBelongTogetherOrSayTooLittle) {
  ASSERT_EQ(simulate("fine.csv", {}).status, 0);
  ASSERT_EQ(simulate("coarse.csv", {"--fiber-radius", "2"}).status, 0);
  expect_refusal(fit({"fine.csv", "coarse.csv"}), "other fibers");
  expect_refusal(fit({"nowhere.csv"}), "nowhere.csv");
  std::ofstream(folder_ / "bare.csv") << "phi_rad,density\n-1.57,0.2\n1.57,0.2\n";
  expect_refusal(fit({"bare.csv"}), "radius");
  std::ofstream(folder_ / "uneven.csv")
      << "# fiber_radius 1\n# thread_radius 10\n# theta_deg 0\n# eta 1.5\n# absorption_per_fiber_radius 0\n"
         "phi_rad,density\n-1.0,0.2\n1.57,0.2\n";
  expect_refusal(fit({"uneven.csv"}), "phi_rad");
  EXPECT_FALSE(fs::exists(folder_ / "fit.json"));
}

TEST_F(ScatterSimulate, DrawsTheThreeFigures) {
  const ProgramResult result = run_threadstation(
      {"scatter", "plot", "--rays", "300", "--configurations", "10", "--quiet", "--out", folder_ / "figures"});
  ASSERT_EQ(result.status, 0) << result.error;
  for (const char* name : {"figure_3", "figure_4", "figure_5"}) {
    EXPECT_GT(fs::file_size(folder_ / "figures" / (std::string(name) + ".png")), 10000U) << name;
    EXPECT_GT(fs::file_size(folder_ / "figures" / (std::string(name) + ".svg")), 10000U) << name;
  }
  std::ofstream(folder_ / "file") << "in the way";
  expect_refusal(run_threadstation({"scatter", "plot", "--quiet", "--out", folder_ / "file"}), "folder");
}

}  // namespace
}  // namespace station_test
