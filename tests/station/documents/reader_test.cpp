#include "station/documents/reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "station/documents/board_file.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"
#include "tests/places.h"
#include "tests/station/documents/refusal.h"

namespace station {
namespace {

using nlohmann::json;
using station_test::refusal;

json good_rig() {
  return read_json_file(std::string(DATA_DIR) + "/rigs/simulated.json");
}

TEST(Documents, EveryRigAndSpoolInFixturesIsRead) {
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(DATA_DIR) + "/rigs")) {
    if (entry.path().extension() != ".json") continue;
    EXPECT_NO_THROW(read_rig(entry.path())) << entry.path();
    ++read;
  }
  for (const auto& entry : std::filesystem::directory_iterator(std::string(DATA_DIR) + "/spools")) {
    if (entry.path().extension() != ".json") continue;
    const Spool spool = read_spool(entry.path());
    EXPECT_EQ(spool.wrapping.turns, 50) << entry.path();
    ASSERT_TRUE(spool.simulation) << entry.path();
    EXPECT_GE(spool.simulation->fibers_per_thread, 10) << entry.path();
    ++read;
  }
  EXPECT_GE(read, 6);
}

TEST(Documents, ACalibrationIsReadAndWrittenWithoutLoss) {
  const std::string file = std::string(DATA_DIR) + "/calibrations/simulated.json";
  const json document = read_json_file(file).flatten(), written = to_json(read_calibration(file)).flatten();
  EXPECT_EQ(written.size(), document.size());
  for (const auto& [key, value] : document.items()) {
    ASSERT_TRUE(written.contains(key)) << key;
    // Degrees become radians and axes are made unit vectors: the last digit may change.
    if (value.is_number_float())
      EXPECT_NEAR(written[key].get<double>(), value.get<double>(), 1e-12 * std::max(1.0, std::abs(value.get<double>())))
          << key;
    else
      EXPECT_EQ(written[key], value) << key;
  }
}

TEST(Documents, EveryBoardInFixturesIsRead) {
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(DATA_DIR) + "/boards")) {
    if (entry.path().extension() != ".json") continue;
    EXPECT_NO_THROW(read_board(entry.path())) << entry.path();
    ++read;
  }
  EXPECT_GE(read, 2);
}

TEST(Documents, TwoTargetsOfARigMayNotShareAnId) {
  json rig = good_rig();
  rig["platform"]["ring"]["first_id"] = 5;
  const std::string message = refusal([&] { parse_rig(rig, "r"); });
  EXPECT_NE(message.find("tag 5"), std::string::npos) << message;
}

TEST(Documents, AnUnknownKeyIsNamedWithItsPath) {
  json rig = good_rig();
  rig["simulation"]["lens"]["focal_lenght_px"] = 3;
  const std::string message = refusal([&] { parse_rig(rig, "my_rig.json"); });
  EXPECT_NE(message.find("my_rig.json"), std::string::npos) << message;
  EXPECT_NE(message.find("simulation.lens.focal_lenght_px"), std::string::npos) << message;
}

TEST(Documents, AMissingKeyAWrongTypeAndAValueOutOfRangeAreNamed) {
  json rig = good_rig();
  rig["platform"].erase("height_mm");
  EXPECT_NE(refusal([&] { parse_rig(rig, "r"); }).find("platform.height_mm"), std::string::npos);
  rig = good_rig();
  rig["platform"]["height_mm"] = "thirty";
  EXPECT_NE(refusal([&] { parse_rig(rig, "r"); }).find("found \"thirty\""), std::string::npos);
  rig = good_rig();
  rig["simulation"]["turntable"]["scale"] = 7;
  EXPECT_NE(refusal([&] { parse_rig(rig, "r"); }).find("from 0.5 to 2"), std::string::npos);
  rig = good_rig();
  rig["simulation"]["samples_per_pixel"] = 18446744073709551615ULL;
  EXPECT_NE(refusal([&] { parse_rig(rig, "r"); }).find("samples_per_pixel"), std::string::npos);
}

TEST(Documents, AnotherKindOfDocumentAndAnotherVersionAreRefused) {
  EXPECT_NE(refusal([] { read_spool(std::string(DATA_DIR) + "/rigs/simulated.json"); }).find("threadstation/rig"),
            std::string::npos);
  json rig = good_rig();
  rig["version"] = 3;
  EXPECT_NE(refusal([&] {
              parse_rig(rig, "r");
            }).find("made by a later threadstation: rig version 3, this one reads up to version 2"),
            std::string::npos);
}

TEST(Documents, AFileCutShortMissingOrAFolderGetsOneLine) {
  const auto folder = std::filesystem::temp_directory_path() / "threadstation_reader_test";
  std::filesystem::create_directories(folder);
  const std::string text = good_rig().dump(2);
  std::ofstream(folder / "cut.json") << text.substr(0, text.size() / 2);
  EXPECT_NE(refusal([&] { read_rig(folder / "cut.json"); }).find("cut short"), std::string::npos);
  EXPECT_NE(refusal([&] { read_rig(folder / "none.json"); }).find("no such file"), std::string::npos);
  EXPECT_NE(refusal([&] { read_rig(folder); }).find("not a readable file"), std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(Documents, TransformsKeepEveryDigitAndMirroredOnesAreRefused) {
  Eigen::Isometry3d pose =
      Eigen::Translation3d(1.0 / 3, -2e5 / 7, 1e-9) * Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized());
  json document{{"format", "threadstation/draft"}, {"version", 1}, {"pose", to_json(pose)}};
  const json parsed = json::parse(document.dump());
  EXPECT_EQ(ObjectReader(parsed, "t", "draft").transform("pose").matrix(), pose.matrix());
  pose.linear().col(0) *= -1;
  document["pose"] = to_json(pose);
  EXPECT_NE(refusal([&] { ObjectReader(document, "t", "draft").transform("pose"); }).find("rigid"), std::string::npos);
}

}  // namespace
}  // namespace station
