// Embroidery files whose content is known because the test writes them, with encoders of its own.
#include "station/documents/motif_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "calibration/colour_chart.h"
#include "renderer/image_file.h"
#include "station/documents/dst_file.h"
#include "station/documents/pes_file.h"
#include "station/documents/scene_file.h"
#include "station/documents/thread_file.h"
#include "tests/places.h"
#include "tests/station/program.h"
#include "tests/station/refusal.h"

namespace station_test {
namespace {

using Eigen::Vector2d;
using renderer::Motif;

enum class Step { stitch, jump, colour };

struct Record {
  Step step;
  int x = 0, y = 0;  // tenths of a millimetre, y up
};

// Balanced ternary, digit by digit.
void put_digits(int value, const std::array<std::pair<int, int>, 5>& bits, std::array<unsigned char, 3>& bytes) {
  for (const auto& [plus, minus] : bits) {  // bit 0 ... 23, the first byte's first; digits of 1, 3, 9, 27, 81
    const int digit = ((value % 3) + 4) % 3 - 1;
    value = (value - digit) / 3;
    if (digit > 0) bytes[static_cast<std::size_t>(plus / 8)] |= static_cast<unsigned char>(1 << plus % 8);
    if (digit < 0) bytes[static_cast<std::size_t>(minus / 8)] |= static_cast<unsigned char>(1 << minus % 8);
  }
}

std::string dst(const std::vector<Record>& records) {
  std::string file = "LA:rose            \rST:  12345\r";
  file.resize(512, ' ');
  for (const Record& record : records) {
    std::array<unsigned char, 3> bytes{0, 0, 0x03};
    put_digits(record.x, {{{0, 1}, {8, 9}, {2, 3}, {10, 11}, {18, 19}}}, bytes);
    put_digits(record.y, {{{7, 6}, {15, 14}, {5, 4}, {13, 12}, {21, 20}}}, bytes);
    if (record.step == Step::jump) bytes[2] |= 0x80;
    if (record.step == Step::colour) bytes[2] |= 0xC0;
    file.append(bytes.begin(), bytes.end());
  }
  return file + std::string("\x00\x00\xF3", 3);
}

void put_coordinate(int value, int flags, std::string& file) {
  if (flags == 0 && value >= -64 && value < 64) {
    file += static_cast<char>(value & 0x7F);
    return;
  }
  file += static_cast<char>(0x80 | flags | ((value >> 8) & 0x0F));
  file += static_cast<char>(value & 0xFF);
}

std::string pes(const std::vector<Record>& records, const std::vector<int>& colours) {
  std::string file = "#PES0001";
  const std::size_t section = 40;
  file += static_cast<char>(section);
  file.resize(section, '\0');
  file += "LA:rose            \r";
  file.resize(section + 48, ' ');
  file += static_cast<char>(colours.size() - 1);
  for (int colour : colours) file += static_cast<char>(colour);
  file.resize(section + 532, ' ');
  for (const Record& record : records) {
    if (record.step == Step::colour) {
      file += "\xFE\xB0\x02";
      continue;
    }
    const int flags = record.step == Step::jump ? 0x20 : 0;
    put_coordinate(record.x, flags, file);
    put_coordinate(-record.y, flags, file);
  }
  return file + std::string("\xFF\x00", 2);
}

std::vector<Record> random_records(int most, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> move(-most, most);
  std::vector<Record> records;
  for (int i = 0; i < 500; ++i) {
    records.push_back({Step::stitch, move(random), move(random)});
    if (i % 100 == 99) records.push_back({Step::colour});
  }
  records.push_back({Step::stitch, 1, 1});
  records.push_back({Step::stitch, 2, 2});
  return records;
}

void expect_points(const Motif& motif, const std::vector<Record>& records) {
  std::vector<Vector2d> expected, found;
  Vector2d at = Vector2d::Zero();
  for (const Record& record : records) {
    at += 0.1 * Vector2d(record.x, record.y);
    if (record.step == Step::stitch) expected.push_back(at);
  }
  for (const renderer::StitchRun& run : motif.runs)
    found.insert(found.end(), run.needle_points.begin(), run.needle_points.end());
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_LT((found[i] - expected[i]).norm(), 1e-9) << i;
}

TEST(MotifFile, EveryMoveOfADstFileIsRead) {
  std::vector<Record> records;
  for (int v = -121; v <= 121; ++v) records.push_back({Step::stitch, v, -v}), records.push_back({Step::stitch, 0, v});
  expect_points(station::parse_dst(dst(records), "rose.dst"), records);
  const std::vector<Record> coloured = random_records(121, 1);
  const Motif motif = station::parse_dst(dst(coloured), "rose.dst");
  EXPECT_EQ(motif.name, "rose");
  EXPECT_EQ(motif.threads.size(), 6U);
  expect_points(motif, coloured);
}

TEST(MotifFile, ThreeJumpsCutTheThreadAndTwoDoNot) {
  const Record sewn{Step::stitch, 10, 0}, jump{Step::jump, 100, 0};
  EXPECT_EQ(station::parse_dst(dst({sewn, sewn, jump, jump, sewn, sewn}), "a").runs.size(), 1U);
  EXPECT_EQ(station::parse_dst(dst({sewn, sewn, jump, jump, jump, sewn, sewn}), "a").runs.size(), 2U);
}

TEST(MotifFile, EveryMoveOfAPesFileIsReadWithItsColours) {
  std::vector<Record> records;
  for (int v = -2047; v <= 2047; v += 23)
    records.push_back({Step::stitch, v, -v}), records.push_back({Step::stitch, -v, 9});
  expect_points(station::parse_pes(pes(records, {5}), "rose.pes"), records);
  const std::vector<Record> coloured = random_records(300, 2);
  const Motif motif = station::parse_pes(pes(coloured, {5, 20, 29, 58, 2, 1}), "rose.pes");
  expect_points(motif, coloured);
  ASSERT_EQ(motif.threads.size(), 6U);
  EXPECT_EQ(motif.threads[0].name, "Red");
  EXPECT_EQ(motif.threads[3].srgb, (std::array<unsigned char, 3>{255, 217, 17}));
  EXPECT_EQ(
      station::parse_pes(
          pes({{Step::stitch, 9, 9}, {Step::jump, 100, 0}, {Step::stitch, 9, 9}, {Step::stitch, 9, 9}}, {200}), "a")
          .runs.size(),
      2U);
}

TEST(MotifFile, FilesCutShortAtAnyByteAreOneLineOrWhole) {
  const std::vector<Record> records = random_records(121, 3);
  for (const auto& [bytes, parse] : {std::pair(dst(records), &station::parse_dst),
                                     std::pair(pes(records, {1, 2, 3, 4, 5, 6}), &station::parse_pes)})
    for (std::size_t size = 0; size < bytes.size() - 3; ++size) {
      const std::string line = refusal([&] { parse(std::string_view(bytes).substr(0, size), "cut.file"); });
      ASSERT_NE(line.find("cut.file"), std::string::npos) << size << ": " << line;
    }
}

TEST(MotifFile, DamagedBytesNeverCrash) {
  std::mt19937 random(4);
  const std::string whole[] = {dst(random_records(121, 5)), pes(random_records(300, 6), {1, 2, 3, 4, 5, 6})};
  for (int i = 0; i < 2000; ++i)
    for (int kind = 0; kind < 2; ++kind) {
      std::string bytes = whole[kind];
      for (int k = 0; k < 4; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      try {
        kind == 0 ? station::parse_dst(bytes, "a") : station::parse_pes(bytes, "a");
      } catch (const std::runtime_error& refused) {
        EXPECT_EQ(std::string(refused.what()).find('\n'), std::string::npos);
      }
    }
}

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
                                       "--thread",    std::string(FIXTURES_DIR) + "/threads/silk_blue.json",
                                       "--out",       folder_ / "motif.exr",
                                       "--px-per-mm", pixels_per_mm,
                                       "--spp",       "32",
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
                          static_cast<int>(place.width * kPixelsPerMm),
                          static_cast<int>(place.height * kPixelsPerMm));
    const cv::Scalar mean = cv::mean(image(pixels));
    const auto matrix =
        station::read_thread(std::string(FIXTURES_DIR) + "/threads/silk_blue.json").linear_srgb_from_camera;
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
  const ProgramResult result = embroider(three_blocks());
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
    EXPECT_EQ(said > 0.1, block == 2) << "threads reflect at their surface: none is as black as black";
  }
  const ProgramResult other = embroider(three_blocks(), {"--colour", "#80a88c", "--seed", "2"});
  ASSERT_EQ(other.status, 0) << other.error;
  const nlohmann::json green = nlohmann::json::parse(other.out).at("threads")[2].at("srgb");
  EXPECT_EQ(green, nlohmann::json({0x80, 0xa8, 0x8c}));
  EXPECT_LT(difference(renderer::read_exr(folder_ / "motif.exr"), green, {-4.5, 22.8, 3, 5}), 2);
}

TEST_F(Embroider, OnASceneItIsSewnWhereAskedAndTheSceneIsWritten) {
  const std::string hoop = std::string(FIXTURES_DIR) + "/scenes/hoop.json";
  const auto sew = [&](const std::vector<std::string>& more, const std::string& out) {
    std::vector<std::string> arguments{"embroider", three_blocks(),
                                       "--thread",  std::string(FIXTURES_DIR) + "/threads/silk_blue.json",
                                       "--out",     out,
                                       "--spp",     "2",
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
  const renderer::Scene made = station::to_scene(scene);
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
  refused(sew({}, std::string(FIXTURES_DIR) + "/scenes/hoop.png"), "written over");
}

TEST_F(Embroider, WhatCannotBeEmbroideredIsOneLine) {
  const auto refused = [&](const ProgramResult& result, const std::string& named) {
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.error_lines(), 1) << result.error;
    EXPECT_NE(result.error.find(named), std::string::npos) << result.error;
  };
  refused(embroider(folder_ / "none.dst"), "no such file");
  refused(embroider(folder_ / "rose.jef"), ".dst");
  refused(embroider(three_blocks(), {"--colour", "red"}), "#c01830");
  refused(embroider(three_blocks(), {}, "1000"), "million pixels");
}

}  // namespace
}  // namespace station_test
