// The cloth command, on what fits leave in a session's folder.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "renderer/picture/image_file.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;

class ClothPreview : public ::testing::Test {
 protected:
  ClothPreview() {
    fs::create_directories(result() / "bundle");
    fs::copy_file(fs::path(DATA_DIR) / "threads/silk_red.json", result() / "thread.json");
    fs::copy_file(fs::path(DATA_DIR) / "bundles/silk_red.json", result() / "bundle/bundle.json");
  }
  ProgramResult cloth(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "cloth", folder_ / "session", "--draft", std::string(DATA_DIR) + "/drafts/plain.json", "--quick", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_threadstation(arguments);
  }
  fs::path result() { return folder_ / "session" / "result"; }
  double swatch_mean() { return cv::mean(renderer::read_exr(result() / "cloth/swatch.exr"))[0]; }

  TemporaryFolder folder_;
};

TEST_F(ClothPreview, IsWovenOfTheBundleOnRequestAndSaysSo) {
  const ProgramResult of_thread = cloth({});
  ASSERT_EQ(of_thread.status, 0) << of_thread.error;
  EXPECT_EQ(nlohmann::json::parse(of_thread.out).at("model"), "thread");
  const double thread_mean = swatch_mean();
  const ProgramResult of_bundle = cloth({"--model", "bundle"});
  ASSERT_EQ(of_bundle.status, 0) << of_bundle.error;
  EXPECT_EQ(nlohmann::json::parse(of_bundle.out).at("model"), "bundle");
  EXPECT_GT(swatch_mean(), 0);
  EXPECT_NE(swatch_mean(), thread_mean);
}

TEST_F(ClothPreview, RefusesToColourABundleAndNamesAModelThatIsMissing) {
  const ProgramResult coloured = cloth({"--model", "bundle", "--warp-colour", "#c01830"});
  EXPECT_EQ(coloured.status, 1);
  EXPECT_NE(coloured.error.find("only a thread's absorption can be changed"), std::string::npos) << coloured.error;
  fs::remove(result() / "bundle/bundle.json");
  const ProgramResult missing = cloth({"--model", "bundle"});
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.error.find("bundle.json"), std::string::npos) << missing.error;
}

}  // namespace
}  // namespace station_test
