// A whole capture through the real drivers over the simulated wire, against the one with devices in process: the same
// bench, the same steps, the same pictures. How far they differ is printed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>

#include "calibration/sensor/sensor_file.h"
#include "rig/devices/clock.h"
#include "station/documents/reader.h"
#include "station/documents/rig_file.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/station/session/hasty_bench.h"

namespace {

using nlohmann::json;
using station_test::ProgramResult;
using station_test::run_threadstation;

json ready_document(const std::string& name) {
  return station::read_json_file(std::string(DATA_DIR) + "/" + name + ".json");
}

std::map<std::string, json> pictures_of(const std::string& session) {
  std::map<std::string, json> pictures;
  std::ifstream journal(session + "/journal.jsonl");
  for (std::string line; std::getline(journal, line);) {
    const json record = json::parse(line);
    if (record["event"] == "picture") pictures[record["data"]["step"]] = record["data"];
  }
  return pictures;
}

// Of two pictures, in standard deviations of what noise alone would make of the same light: of all pixels, and of the
// mean level.
struct Difference {
  double pixels = 0, mean = 0;
};

Difference difference(const calibration::SensorPicture& a, const calibration::SensorPicture& b,
                      const rig::TrueSensor& sensor) {
  const double dn_per_e = (sensor.white_level_dn - sensor.black_level_dn) / sensor.full_well_e;  // at ISO 100
  double normalised = 0, sum_dn = 0, variance_dn2 = 0;
  for (int row = 0; row < a.mosaic.rows; ++row)
    for (int column = 0; column < a.mosaic.cols; ++column) {
      const double x = a.mosaic(row, column), y = b.mosaic(row, column);
      const double counted_e = std::max(0.0, (x + y) / 2 - sensor.black_level_dn) / dn_per_e;
      const double pixel_dn2 = 2 * (counted_e + sensor.read_noise_e * sensor.read_noise_e) * dn_per_e * dn_per_e;
      normalised += (x - y) * (x - y) / pixel_dn2;
      sum_dn += x - y;
      variance_dn2 += pixel_dn2;
    }
  return {std::sqrt(normalised / static_cast<double>(a.mosaic.total())), std::abs(sum_dn) / std::sqrt(variance_dn2)};
}

struct WireCapture : testing::TestWithParam<const char*> {
  void SetUp() override {
    json calibration = station_test::hasty_calibration(ready_document("calibrations/simulated"));
    calibration["utc"] = rig::SystemClock().utc();  // it must not be too old
    std::filesystem::create_directory(folder / "calibration");
    station::write_json_file(folder / "calibration/calibration.json", calibration);
  }
  std::map<std::string, json> capture(const std::string& name, const json& rig) const {
    station::write_json_file(folder / (name + "-rig.json"), rig);
    const std::string session = folder / name;
    const ProgramResult captured = run_threadstation(
        {"capture", "--rig", folder / (name + "-rig.json"), "--calibration", folder / "calibration", "--spool",
         std::string(DATA_DIR) + "/spools/silk_red.json", "--out", session, "--unattended", "--quiet"});
    EXPECT_EQ(captured.status, 0) << captured.error;
    const ProgramResult verified = run_threadstation({"verify", session});
    EXPECT_EQ(verified.status, 0) << verified.error;
    return pictures_of(session);
  }
  calibration::SensorPicture picture(const std::string& session, const json& record) const {
    return calibration::read_sensor_file(folder / session / record["file"].get<std::string>());
  }
  station_test::TemporaryFolder folder;
};

INSTANTIATE_TEST_SUITE_P(OverThe, WireCapture, testing::Values("grbl", "zaber"),
                         [](const auto& turntable) { return std::string(turntable.param); });

}  // namespace

TEST_P(WireCapture, GivesTheSessionOfTheDevicesInProcess) {
  const json rig = station_test::hasty_rig(ready_document("rigs/simulated"));
  const auto expected = capture("in-process", rig);
  const json wire = ready_document("rigs/simulated_wire_" + std::string(GetParam()));
  json wired = rig;
  for (const char* key : {"camera", "camera_connection", "turntable", "turntable_setup"}) wired[key] = wire[key];
  const auto found = capture("wire", wired);
  EXPECT_EQ(std::ranges::count_if(found, [](const auto& one) { return one.second["kind"] == "view"; }), 17);
  ASSERT_EQ(found.size(), expected.size());
  const rig::TrueSensor sensor = station::read_rig((folder / "in-process-rig.json").string()).simulation->truth.sensor;
  Difference worst;
  for (const auto& [step, record] : expected) {
    SCOPED_TRACE(step);
    ASSERT_TRUE(found.contains(step));
    const json& same = found.at(step);
    EXPECT_EQ(same["camera_asked"], record["camera_asked"]);
    for (const char* key : {"mounting", "lamp", "room_light"}) EXPECT_EQ(same[key], record[key]);
    EXPECT_NEAR(same["platform_angle_read_deg"].get<double>(), record["platform_angle_read_deg"].get<double>(), 1e-9);
    const Difference here = difference(picture("wire", same), picture("in-process", record), sensor);
    EXPECT_LT(here.pixels, 1.1);  // 1 for pictures of independent noise; 15000 pixels scatter by less than 0.01
    EXPECT_LT(here.mean, 5);      // standard errors
    worst = {std::max(worst.pixels, here.pixels), std::max(worst.mean, here.mean)};
  }
  std::cout << GetParam() << ": " << found.size() << " pictures differ by at most " << worst.pixels
            << " of their noise in their pixels and " << worst.mean << " standard errors in their means\n";
}
