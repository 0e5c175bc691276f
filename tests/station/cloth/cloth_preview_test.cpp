// The cloth command, on what fits leave in a session's folder.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <vector>

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
    std::vector<std::string> arguments{"cloth",   folder_ / "session",
                                       "--draft", std::string(DATA_DIR) + "/drafts/plain.json",
                                       "--quick", "--size",
                                       "240",     "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_threadstation(arguments);
  }
  fs::path result() { return folder_ / "session" / "result"; }
  double swatch_mean() { return cv::mean(renderer::read_exr(result() / "cloth/swatch.exr"))[0]; }

  TemporaryFolder folder_;
};

TEST_F(ClothPreview, IsWovenOfTheBundleOnRequestAndSaysSo) {
  const ProgramResult of_thread = cloth({"--shape", "swatch"});
  ASSERT_EQ(of_thread.status, 0) << of_thread.error;
  EXPECT_EQ(nlohmann::json::parse(of_thread.out).at("model"), "thread");
  const double thread_mean = swatch_mean();
  const ProgramResult of_bundle = cloth({"--shape", "swatch", "--model", "bundle"});
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
                              std::string(DATA_DIR) + "/drafts/plain.json", "--quick", "--size", "240", "--json",
                              "--out", folder_ / "design"});
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

// What it is of, from which side, how large; and what an earlier rendering left does not stand in the way.
TEST_F(ClothPreview, IsOfTheShapeAndTheViewThatAreAskedFor) {
  const fs::path folder = folder_ / "design", picture = folder / "swatch.exr";
  const auto design = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"cloth",   std::string(DATA_DIR) + "/threads/silk_red.json",
                                   "--draft", std::string(DATA_DIR) + "/drafts/plain.json",
                                   "--out",   folder,
                                   "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_threadstation(words);
  };
  ASSERT_EQ(design({"--shape", "swatch", "--size", "200"}).status, 0);
  EXPECT_FALSE(fs::exists(folder / "cylinder.exr"));
  const cv::Mat3f ahead = renderer::read_exr(picture);
  EXPECT_EQ(ahead.size(), cv::Size(200, 200));
  std::ofstream(folder / "swatch.exr.checkpoint") << "of something else";
  const ProgramResult turned = design({"--shape", "swatch", "--size", "200", "--turn", "60"});
  ASSERT_EQ(turned.status, 0) << turned.error;
  const auto made_of = nlohmann::json::parse(turned.out);
  EXPECT_EQ(made_of.at("views").at("swatch").at("turn_deg"), 60);
  EXPECT_FALSE(made_of.contains("reflectance")) << "it is told of the swatch as it stands";
  // A square that is turned by 60 degrees is half as wide.
  const auto share = [](const cv::Mat3f& one) {
    cv::Mat1f grey;
    cv::transform(one, grey, cv::Matx13f(1, 1, 1));
    return cv::countNonZero(grey > 0) / static_cast<double>(grey.total());
  };
  EXPECT_NEAR(share(renderer::read_exr(picture)) / share(ahead), 0.5, 0.08);
  ASSERT_EQ(design({"--shape", "swatch", "--size", "200", "--light-turn", "180"}).status, 0);
  const cv::Mat3f behind = renderer::read_exr(picture);
  EXPECT_NEAR(share(behind) / share(ahead), 1, 0.02) << "seen as before";
  EXPECT_GT(std::abs(cv::mean(behind)[0] / cv::mean(ahead)[0] - 1), 0.2) << "lit from behind";

  const ProgramResult spun = design({"--shape", "swatch", "--size", "200", "--fibers", "spun"});
  ASSERT_EQ(spun.status, 0) << spun.error;
  EXPECT_EQ(nlohmann::json::parse(spun.out).at("fibers"), "spun");
  EXPECT_GT(cv::norm(renderer::read_exr(picture), ahead, cv::NORM_L1) / cv::norm(ahead, cv::NORM_L1), 0.05);
  EXPECT_NE(design({"--fibers", "felt"}).status, 0);

  EXPECT_NE(design({"--shape", "cube"}).status, 0);
  const ProgramResult large = design({"--size", "1000000"});
  EXPECT_EQ(large.status, 1);
  EXPECT_NE(large.error.find("1000000 pixels"), std::string::npos) << large.error;
}

// Lines on its input turn it, the last picture is as good as was asked for, and what is no line ends it.
TEST_F(ClothPreview, ALookGetsBetterAndTurns) {
  const std::string look = std::string(THREADSTATION_PROGRAM) + " look " + DATA_DIR +
                           "/threads/silk_red.json --draft " + DATA_DIR +
                           "/drafts/plain.json --spp 16 --size 360 --json --out " + (folder_ / "look").string();
  const ProgramResult looked = run_shell(R"((echo '{"look": 5, "turn_deg": 60}'; sleep 1) | )" + look);
  ASSERT_EQ(looked.status, 0) << looked.error;
  std::vector<nlohmann::json> shown;
  std::istringstream lines(looked.out);
  for (std::string line; std::getline(lines, line);) shown.push_back(nlohmann::json::parse(line).at("shown"));
  ASSERT_GE(shown.size(), 3U);
  EXPECT_EQ(shown.back().at("look"), 5);
  EXPECT_EQ(shown.back().at("samples"), 16);
  for (std::size_t i = 1; i < shown.size(); ++i) {
    EXPECT_EQ(shown[i].at("picture"), shown[i - 1].at("picture").get<int>() + 1);
    EXPECT_GE(shown[i].at("samples"), shown[i - 1].at("samples"));
  }
  // The same cloth by the other command, drawn with other samples.
  ASSERT_EQ(cloth({"--shape", "swatch", "--turn", "60"}).status, 0);
  const cv::Scalar seen = cv::mean(renderer::read_linear_srgb(folder_ / "look" / "look.png")),
                   woven = cv::mean(renderer::read_linear_srgb(result() / "cloth/swatch.png"));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c] / woven[c], 1, 0.05) << c;

  for (const char* line : {"turn it", R"({"look": 1, "zoom": 0})"}) {
    const ProgramResult refused = run_shell(std::string("(echo '") + line + "'; sleep 1) | " + look);
    EXPECT_EQ(refused.status, 1);
    EXPECT_EQ(refused.error_lines(), 1) << refused.error;
  }
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
