// The cloth command, on what fits leave in a session's folder.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
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

// The card's radiance from the scenes' lights by hand: (I cos / d^2 + pi L) / pi of the lamp and the surroundings.
TEST_F(ClothPreview, IsAsBrightAsItIsBesideAWhiteCard) {
  const ProgramResult of_thread = cloth({});
  ASSERT_EQ(of_thread.status, 0) << of_thread.error;
  const auto made_of = nlohmann::json::parse(of_thread.out);
  const Eigen::Vector3d lamp(-150, 200, 400);
  const double swatch = 200000 * lamp.normalized().z() / lamp.squaredNorm() / std::numbers::pi + 0.1;
  const Eigen::Vector3d front(41, 0, 84), to_eye = (Eigen::Vector3d(700, 0, 180) - front).normalized(),
                                          to_lamp = Eigen::Vector3d(500, -400, 350) - front;
  const double cylinder = 600000 * to_lamp.normalized().dot(to_eye) / to_lamp.squaredNorm() / std::numbers::pi + 0.15;
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(made_of.at("white_card").at("swatch")[c].get<double>() / swatch, 1, 0.01);
    EXPECT_NEAR(made_of.at("white_card").at("cylinder")[c].get<double>() / cylinder, 1, 0.01);
  }
  // The picture for people is the reflectance, clipped.
  const cv::Mat3f linear = renderer::read_exr(result() / "cloth/swatch.exr");
  cv::Mat3f asked;
  cv::min(linear / swatch, 1.0, asked);
  const cv::Scalar shown = cv::mean(renderer::read_linear_srgb(result() / "cloth/swatch.png")),
                   wanted = cv::mean(asked);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(shown[c] / wanted[c], 1, 0.02) << c;
  const auto mean = made_of.at("reflectance");
  EXPECT_GT(mean[0].get<double>(), 1.5 * mean[1].get<double>()) << "red silk";
  EXPECT_LT(mean[0].get<double>(), 1);
}

// Threads that no session of this computer made, in a folder that stands alone.
TEST_F(ClothPreview, OfTwoThreadFilesIsADesignOfItsOwn) {
  const auto thread = [&](const std::string& name) { return std::string(DATA_DIR) + "/threads/" + name + ".json"; };
  const auto design = [&](const std::string& weft) {
    return run_threadstation({"cloth", thread("silk_red"), "--weft", weft, "--draft",
                              std::string(DATA_DIR) + "/drafts/plain.json", "--quick", "--json", "--out",
                              folder_ / "design"});
  };
  const auto blueness = [&] {
    const cv::Scalar mean = cv::mean(renderer::read_exr(folder_ / "design/swatch.exr"));
    return mean[2] / mean[0];
  };
  const ProgramResult of_one = design(thread("silk_red"));
  ASSERT_EQ(of_one.status, 0) << of_one.error;
  const double red = blueness();
  const ProgramResult of_two = design(thread("silk_blue"));
  ASSERT_EQ(of_two.status, 0) << of_two.error;
  const auto threads = nlohmann::json::parse(of_two.out).at("threads");
  EXPECT_NE(threads[0], threads[1]);
  EXPECT_GT(blueness(), 1.5 * red) << "a blue weft";
  // The folder can be taken elsewhere and rendered there.
  fs::rename(folder_ / "design", folder_ / "elsewhere");
  const ProgramResult rendered =
      run_threadstation({"render", folder_ / "elsewhere/cylinder.json", "--spp", "1", "--out", folder_ / "again.exr"});
  EXPECT_EQ(rendered.status, 0) << rendered.error;

  const ProgramResult nowhere = run_threadstation(
      {"cloth", thread("silk_red"), "--draft", std::string(DATA_DIR) + "/drafts/plain.json", "--quick"});
  EXPECT_EQ(nowhere.status, 1);
  EXPECT_NE(nowhere.error.find("say where it goes with --out"), std::string::npos) << nowhere.error;
  nlohmann::json other = nlohmann::json::parse(std::ifstream(thread("silk_blue")));
  other["linear_srgb_from_camera"] = {1.6, -0.5, -0.1, -0.2, 1.5, -0.3, 0, -0.4, 1.4};
  std::ofstream(folder_ / "other.json") << other;
  const ProgramResult mixed = design(folder_ / "other.json");
  EXPECT_EQ(mixed.status, 1);
  EXPECT_NE(mixed.error.find("two cameras"), std::string::npos) << mixed.error;
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
