// The embroider command, on motifs that the tests write.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "calibration/light/colour_chart.h"
#include "renderer/picture/image_file.h"
#include "station/cloth/render/build_scene.h"
#include "station/documents/thread_file.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/station/documents/encoded_motifs.h"

namespace station_test {
namespace {

class Embroider : public ::testing::Test {
 protected:
  // Three blocks of satin, each in a colour of its own.
  std::string three_blocks() {
    std::vector<Record> records;
    for (int block = 0; block < 3; ++block) {
      if (block > 0) records.push_back({Step::colour}), records.push_back({Step::jump, 0, 20});
      for (int i = 0; i < 24; ++i) records.push_back({Step::stitch, i % 2 == 0 ? -60 : 60, i % 2 == 0 ? 3 : 4});
    }
    const std::string file = folder_ / "blocks.pes";
    std::ofstream(file, std::ios::binary) << pes(records, {39, 46, 20});
    return file;
  }
  ProgramResult embroider(const std::string& motif, const std::vector<std::string>& more = {},
                          const std::string& pixels_per_mm = "8") {
    std::vector<std::string> arguments{"embroider",   motif,
                                       "--thread",    std::string(DATA_DIR) + "/threads/silk_blue.json",
                                       "--out",       folder_ / "motif.exr",
                                       "--px-per-mm", pixels_per_mm,
                                       "--spp",       "8",
                                       "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_threadstation(arguments);
  }
  // CIEDE2000 between a wanted colour and the mean of what is seen in a rectangle of the cloth (mm).
  double difference(const cv::Mat3f& image, const nlohmann::json& wanted, const cv::Rect2d& place) {
    constexpr double kPixelsPerMm = 8, kMargin_mm = 1.2;
    const double low_x = -6, high_y = 29.3;
    const cv::Rect pixels(static_cast<int>((place.x - low_x + kMargin_mm) * kPixelsPerMm),
                          static_cast<int>((high_y + kMargin_mm - place.y - place.height) * kPixelsPerMm),
                          static_cast<int>(place.width * kPixelsPerMm), static_cast<int>(place.height * kPixelsPerMm));
    return delta_e(cv::mean(image(pixels)), wanted);
  }
  double delta_e(const cv::Scalar& mean, const nlohmann::json& wanted) {
    const auto matrix = station::read_thread(std::string(DATA_DIR) + "/threads/silk_blue.json").linear_srgb_from_camera;
    Eigen::Vector3d seen, asked;
    for (int c = 0; c < 3; ++c) {
      const auto row = static_cast<std::size_t>(3 * c);
      seen[c] = matrix[row] * mean[0] + matrix[row + 1] * mean[1] + matrix[row + 2] * mean[2];
      asked[c] = std::pow((wanted[static_cast<std::size_t>(c)].get<double>() / 255 + 0.055) / 1.055, 2.4);
    }
    return calibration::delta_e_2000(calibration::lab_of_linear_srgb(seen), calibration::lab_of_linear_srgb(asked));
  }
  TemporaryFolder folder_;
};

TEST_F(Embroider, SatinInGamutHasTheFilesColoursWithinTwoAndElseIsOffAsSaid) {
  const ProgramResult result = embroider(three_blocks(), {"--curves-only"});
  ASSERT_EQ(result.status, 0) << result.error;
  const nlohmann::json made = nlohmann::json::parse(result.out);
  EXPECT_NEAR(made.at("width_mm").get<double>(), 6, 1e-9);
  ASSERT_EQ(made.at("threads").size(), 3U);
  const cv::Mat3f image = renderer::read_exr(folder_ / "motif.exr");
  for (int block = 0; block < 3; ++block) {
    const nlohmann::json& thread = made["threads"][static_cast<std::size_t>(block)];
    EXPECT_EQ(thread.at("stitches"), 23);
    const double said = thread.at("delta_e_2000").get<double>();
    const double found = difference(image, thread.at("srgb"), {-4.5, 10.4 * block + 2, 3, 5});
    std::printf("%s: CIEDE2000 %.2f, said %.2f\n", thread.at("name").get<std::string>().c_str(), found, said);
    EXPECT_NEAR(found, said, 2) << thread.at("name");
    EXPECT_EQ(thread.at("out_of_gamut"), block == 2) << "threads reflect at their surface: none is as black as black";
  }
  const ProgramResult other = embroider(three_blocks(), {"--curves-only", "--colour", "#80a88c", "--seed", "2"});
  ASSERT_EQ(other.status, 0) << other.error;
  const nlohmann::json green = nlohmann::json::parse(other.out).at("threads")[2].at("srgb");
  EXPECT_EQ(green, nlohmann::json({0x80, 0xa8, 0x8c}));
  EXPECT_LT(difference(renderer::read_exr(folder_ / "motif.exr"), green, {-4.5, 22.8, 3, 5}), 2);
}

// Narrow stripes of satin side by side, light and dark in turn: each has the light of its neighbours, which the curve
// of satin alone does not know.
TEST_F(Embroider, StripesHaveTheirColoursBesideEachOther) {
  constexpr int kStripes = 8;
  std::vector<Record> records;
  std::vector<int> colours;
  for (int stripe = 0; stripe < kStripes; ++stripe) {
    if (stripe > 0) records.push_back({Step::colour});
    for (int i = 0; i < 4; ++i) records.push_back({Step::stitch, i % 2 == 0 ? -60 : 60, i % 2 == 0 ? 3 : 4});
    colours.push_back(stripe % 2 == 0 ? 39 : 46);
  }
  const std::string file = folder_ / "stripes.pes";
  std::ofstream(file, std::ios::binary) << pes(records, colours);
  std::vector<double> off;
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{"--curves-only"}, std::vector<std::string>{"--seed", "3"}}) {
    std::vector<std::string> options{"--colour", "#c8b0a8", "#989098"};
    options.insert(options.end(), how.begin(), how.end());
    const ProgramResult result = embroider(file, options);
    ASSERT_EQ(result.status, 0) << result.error;
    const nlohmann::json threads = nlohmann::json::parse(result.out).at("threads");
    const cv::Mat3f image = renderer::read_exr(folder_ / "motif.exr");
    double sum = 0;
    for (int stripe = 1; stripe + 1 < kStripes; ++stripe) {
      // Pictures begin three diameters below the lowest and left of the leftmost needle point.
      constexpr double kPixelsPerMm = 8, kMargin_mm = 1.2, kStripe_mm = 1.4;
      const double top_mm = kStripes * kStripe_mm + kMargin_mm - (stripe + 1) * kStripe_mm;
      const cv::Rect pixels(static_cast<int>((1.5 + kMargin_mm) * kPixelsPerMm),
                            static_cast<int>((top_mm + 0.35) * kPixelsPerMm), static_cast<int>(3 * kPixelsPerMm),
                            static_cast<int>(0.7 * kPixelsPerMm));
      sum += delta_e(cv::mean(image(pixels)), threads[static_cast<std::size_t>(stripe)].at("srgb"));
    }
    off.push_back(sum / (kStripes - 2));
  }
  std::printf("stripes: CIEDE2000 %.2f by the curve alone, %.2f on the motif\n", off[0], off[1]);
  EXPECT_LT(off[1], 0.6 * off[0]);
}

TEST_F(Embroider, OnASceneItIsSewnWhereAskedAndTheSceneIsWritten) {
  const std::string hoop = std::string(DATA_DIR) + "/scenes/hoop.json";
  const auto sew = [&](const std::vector<std::string>& more, const std::string& out) {
    std::vector<std::string> arguments{"embroider", three_blocks(),
                                       "--thread",  std::string(DATA_DIR) + "/threads/silk_blue.json",
                                       "--out",     out,
                                       "--spp",     "1",
                                       "--scene",   hoop,
                                       "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_threadstation(arguments);
  };
  const ProgramResult result = sew({"--at", "50", "70", "--turn", "90"}, folder_ / "hoop.exr");
  ASSERT_EQ(result.status, 0) << result.error;
  const station::SceneFile scene = station::read_scene(folder_ / "hoop.json");
  ASSERT_EQ(scene.embroideries.size(), 1U);
  EXPECT_EQ(scene.embroideries[0].threads.size(), 3U);
  station::ProgressDisplay quiet("test", station::ProgressStyle::quiet);
  const renderer::Scene made = station::build_scene(scene, station::build_cloths(scene, quiet));
  EXPECT_EQ(made.cloths.size(), 1U) << "the ground is cloth in two scales";
  ASSERT_EQ(made.curves.size(), 3U);
  Eigen::AlignedBox3f bounds;
  for (const renderer::CurveSet& set : made.curves)
    for (const Eigen::Vector4f& point : set.control_points) bounds.extend(point.head<3>());
  // The swatch is 130 mm wide, its patch begins at its lower left corner; the motif is 6 mm wide and was turned.
  EXPECT_NEAR(bounds.center().x(), 50 - 65, 0.5F);
  EXPECT_NEAR(bounds.center().y(), 70 - 65, 0.5F);
  EXPECT_NEAR(bounds.sizes().y(), 6, 0.8F);
  EXPECT_GT(bounds.max().z(), 0.3F) << "above the cloth's yarns";
  EXPECT_EQ(renderer::read_exr(folder_ / "hoop.exr").cols, scene.camera.width);
  const auto refused = [](const ProgramResult& no, const std::string& named) {
    EXPECT_EQ(no.status, 1);
    EXPECT_NE(no.error.find(named), std::string::npos) << no.error;
  };
  refused(sew({"--at", "1", "1"}, folder_ / "beside.exr"), "beside it");
  refused(sew({"--cloth", "1"}, folder_ / "none.exr"), "counted from 0");
  refused(sew({}, std::string(DATA_DIR) + "/scenes/hoop.png"), "written over");
}

TEST_F(Embroider, WhatCannotBeEmbroideredIsOneLine) {
  const auto refused = [&](const ProgramResult& result, const std::string& named) {
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.error_lines(), 1) << result.error;
    EXPECT_NE(result.error.find(named), std::string::npos) << result.error;
  };
  refused(embroider(folder_ / "none.dst"), "no such file");
  refused(embroider(folder_ / "rose.jef"), ".dst");
  refused(embroider(three_blocks(), {"--colour", "mauvelous"}), "#c01830");
  refused(embroider(three_blocks(), {}, "1000"), "million pixels");
}

}  // namespace
}  // namespace station_test
