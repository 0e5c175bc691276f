// Pictures in cloth, through the program: photographs, what is written, ready scenes with a picture, and refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/light/colour_chart.h"
#include "renderer/picture/image_file.h"
#include "station/cloth/render/build_scene.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

using nlohmann::json;

// Of Debian's opencv-doc.
const std::string kPhotographs = "/usr/share/doc/opencv-doc/examples/data/";
const std::string kData = DATA_DIR;

class PatternCommand : public ::testing::Test {
 protected:
  ProgramResult pattern(const std::string& image, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"pattern", "--image", image, "--out", folder_ / "out", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_threadstation(arguments);
  }
  ProgramResult woven(const std::string& image, int ends) {
    return pattern(image, {"--thread", kData + "/threads/silk_gold.json", "--draft", kData + "/drafts/satin_5.json",
                           "--ends", std::to_string(ends)});
  }
  std::string picture(const std::string& name, const cv::Mat3b& rgb) {
    renderer::write_png(folder_ / name, rgb);
    return folder_ / name;
  }
  TemporaryFolder folder_;
};

Eigen::Vector3d lab(const cv::Vec3f& rgb) {
  return calibration::lab_of_linear_srgb(
      {static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])});
}

cv::Mat3f linear_srgb(const cv::Mat3f& camera_rgb, const std::filesystem::path& folder) {
  auto m = station::read_scene(folder / "scene.json").linear_srgb_from_camera;
  cv::Mat3f linear;
  cv::transform(camera_rgb, linear, cv::Mat(3, 3, CV_64F, m.data()));
  return linear;
}

// Of the scene that was written, rendered with two pixels to a crossing's width: means over the crossings, linear sRGB.
cv::Mat3f rendered_crossings(const std::filesystem::path& folder, int ends, int picks) {
  json scene = station::read_json_file(folder / "scene.json");
  json& camera = scene["camera"];
  const double zoom = 2.0 * ends / camera["width_px"].get<double>();
  camera["width_px"] = 2 * ends;
  camera["height_px"] = static_cast<int>(std::lround(camera["height_px"].get<double>() * zoom));
  camera["focal_length_px"] = camera["focal_length_px"].get<double>() * zoom;
  std::ofstream(folder / "small.json") << scene;
  const ProgramResult made =
      run_threadstation({"render", folder / "small.json", "--spp", "128", "--out", folder / "small.exr"});
  EXPECT_EQ(made.status, 0) << made.error;
  cv::Mat3f crossings;
  cv::resize(renderer::read_exr(folder / "small.exr"), crossings, {ends, picks}, 0, 0, cv::INTER_AREA);
  return linear_srgb(crossings, folder);
}

// CIEDE2000 of two pictures but for their border: a swatch ends there, and light comes in from the side.
double mean_error(const cv::Mat3f& a, const cv::Mat3f& b) {
  constexpr int kBorder = 4;
  double sum = 0;
  int count = 0;
  for (int row = kBorder; row < a.rows - kBorder; ++row)
    for (int column = kBorder; column < a.cols - kBorder; ++column, ++count)
      sum += calibration::delta_e_2000(lab(a(row, column)), lab(b(row, column)));
  return sum / count;
}

TEST_F(PatternCommand, PhotographsAreRenderedWithinThree) {
  for (const char* name : {"fruits.jpg", "butterfly.jpg"}) {
    const ProgramResult result = woven(kPhotographs + name, 70);
    ASSERT_EQ(result.status, 0) << result.error;
    const json report = json::parse(result.out);
    const double by_curves = report["delta_e_2000"]["by_curves"]["mean"],
                 refined = report["delta_e_2000"]["refined"]["mean"];
    const cv::Mat3f asked = linear_srgb(renderer::read_exr(folder_ / "out" / "asked.exr"), folder_ / "out"),
                    found = rendered_crossings(folder_ / "out", report.at("ends"), report.at("picks"));
    const double rendered = mean_error(found, asked);
    std::printf("%s: CIEDE2000 %.2f rendered, %.2f said, %.2f by the curves; %.1f %% out of gamut as it is\n", name,
                rendered, refined, by_curves, 100 * report["out_of_gamut"].get<double>());
    EXPECT_LT(rendered, 3);
    EXPECT_LT(refined, 0.7 * by_curves);
  }
}

TEST_F(PatternCommand, ColoursAsTheyAreAreMetWithinTheGamut) {
  // Greys and pastels that silk reaches, beside black, which it does not.
  cv::Mat3b patches(40, 60, cv::Vec3b(170, 165, 160));
  patches(cv::Rect(20, 0, 20, 40)).setTo(cv::Scalar(205, 170, 175));
  patches(cv::Rect(0, 25, 60, 15)).setTo(cv::Scalar(5, 5, 5));
  const ProgramResult result =
      pattern(picture("patches.png", patches),
              {"--thread", kData + "/threads/silk_gold.json", "--draft", kData + "/drafts/satin_5.json", "--as-it-is"});
  ASSERT_EQ(result.status, 0) << result.error;
  const json report = json::parse(result.out);
  EXPECT_NEAR(report.at("out_of_gamut").get<double>(), 15.0 / 40, 0.05);
  EXPECT_LT(report["delta_e_2000"]["refined"]["mean"].get<double>(), 1);
  EXPECT_GT(report["delta_e_2000"]["refined_of_picture"]["percentile_95"].get<double>(), 20) << "black";
}

TEST_F(PatternCommand, WritesWhatItSaysAndCurvesAloneAreTheSameTwice) {
  cv::Mat3b colours(12, 16, cv::Vec3b(150, 120, 100));
  colours(cv::Rect(4, 3, 5, 5)).setTo(cv::Scalar(110, 150, 140));
  colours(0, 0) = {255, 255, 255};
  const ProgramResult result = woven(picture("small.png", colours), 16);
  ASSERT_EQ(result.status, 0) << result.error;
  const json report = json::parse(result.out);
  EXPECT_EQ(report, station::read_json_file(folder_ / "out" / "pattern.json"));
  EXPECT_EQ(report.at("ends"), 16);
  EXPECT_GE(report.at("out_of_gamut").get<double>(), 1.0 / 192) << "nothing is as white as white";
  const cv::Mat3f sigma_a = renderer::read_exr(folder_ / "out" / "absorption.exr");
  EXPECT_EQ(sigma_a.cols, 16);
  EXPECT_EQ(sigma_a.rows, report.at("picks"));
  const station::SceneFile scene = station::read_scene(folder_ / "out" / "scene.json");
  ASSERT_TRUE(scene.cloths.at(0).absorption);
  EXPECT_NEAR(scene.cloths[0].absorption->texel_mm.x() * 16, report.at("width_mm").get<double>(), 1e-9);
  EXPECT_GT(renderer::read_linear_srgb(folder_ / "out" / "pattern.png").cols, 1000);
}

TEST_F(PatternCommand, AReadySceneIsWrittenAgainWithThePictureInItsCloth) {
  const std::string image = picture("stripes.png", cv::Mat3b(8, 8, cv::Vec3b(150, 120, 100)));
  const ProgramResult result = pattern(image, {"--scene", kData + "/scenes/satin_drape.json", "--curves-only"});
  ASSERT_EQ(result.status, 0) << result.error;
  const station::SceneFile scene = station::read_scene(folder_ / "out" / "scene.json"),
                           ready = station::read_scene(kData + "/scenes/satin_drape.json");
  EXPECT_EQ(scene.threads.size(), ready.threads.size());
  ASSERT_TRUE(scene.cloths.at(0).absorption);
  EXPECT_FALSE(ready.cloths.at(0).absorption);
  station::ProgressDisplay quiet("test", station::ProgressStyle::quiet);
  EXPECT_TRUE(station::build_scene(scene, station::build_cloths(scene, quiet)).cloths.at(0).absorption);
}

TEST_F(PatternCommand, AJacquardHasThePictureInItsStructure) {
  cv::Mat3b halves(96, 96, cv::Vec3b(250, 250, 250));
  halves(cv::Rect(0, 0, 48, 96)).setTo(cv::Scalar(10, 10, 30));
  const ProgramResult result =
      pattern(picture("halves.png", halves),
              {"--thread", kData + "/threads/cotton_white.json", "--jacquard", kData + "/threads/silk_blue.json",
               "--draft", kData + "/drafts/jacquard/draft.json", "--ends", "48"});
  ASSERT_EQ(result.status, 0) << result.error;
  const json report = json::parse(result.out);
  EXPECT_EQ(report, station::read_json_file(folder_ / "out" / "jacquard.json"));
  const json& shades = report.at("shades_linear_srgb");
  for (std::size_t shade = 1; shade < 7; ++shade)
    EXPECT_GT(shades[shade][0].get<double>(), shades[shade - 1][0].get<double>()) << "the warp is white, the weft blue";
  const json structure = station::read_json_file(folder_ / "out" / "draft.json").at("structure");
  ASSERT_EQ(structure.size(), report.at("picks").get<std::size_t>());
  for (const json& pick : structure) {
    const std::string marks = pick;
    EXPECT_EQ(std::count(marks.begin(), marks.begin() + 24, 'X'), 3) << "weft-faced";
    EXPECT_EQ(std::count(marks.begin() + 24, marks.end(), 'X'), 21) << "warp-faced";
  }
  const station::SceneFile scene = station::read_scene(folder_ / "out" / "scene.json");
  const auto& draft = std::get<renderer::Draft>(scene.cloths.at(0).weave);
  EXPECT_EQ(renderer::ends_in_patch(draft), 48);
  EXPECT_EQ(renderer::picks_in_patch(draft), static_cast<int>(structure.size()));
}

TEST_F(PatternCommand, WhatCannotBeWovenIsOneLine) {
  const std::string thread = kData + "/threads/silk_gold.json", draft = kData + "/drafts/satin_5.json",
                    grey = picture("grey.png", cv::Mat3b(4, 4, cv::Vec3b(128, 128, 128)));
  const auto refused = [&](const ProgramResult& result, const std::string& named, int status = 1) {
    EXPECT_EQ(result.status, status) << result.error;
    EXPECT_EQ(result.error_lines(), 1) << result.error;
    EXPECT_NE(result.error.find(named), std::string::npos) << result.error;
  };
  refused(woven(folder_ / "none.png", 4), "no such file");
  std::ofstream(folder_ / "text.png") << "not a picture";
  refused(woven(folder_ / "text.png", 4), "text.png");
  const std::string whole = [&] {
    std::ifstream file(grey, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  }();
  std::ofstream(folder_ / "cut.png", std::ios::binary) << whole.substr(0, whole.size() - 20);
  refused(woven(folder_ / "cut.png", 4), "cut.png");
  refused(woven(grey, 1 << 20), "crossings");
  refused(pattern(grey, {}), "thread and a draft");
  refused(pattern(grey, {"--scene", kData + "/scenes/satin_drape.json", "--cloth", "3"}), "counted from 0");
  refused(pattern(grey, {"--scene", folder_ / "none.json"}), "none.json");
  std::ofstream(folder_ / "out") << "a file";
  refused(woven(grey, 4), folder_ / "out");
  EXPECT_EQ(pattern(grey, {"--thread", thread}).status, 2);
  EXPECT_EQ(pattern(grey, {"--thread", thread, "--draft", draft, "--ends", "0"}).status, 2);
}

}  // namespace
}  // namespace station_test
