// Whole calibrations guided by the page: how much a person has to do, and how long it takes.
#include <ctime>

#include "station/documents/calibration_file.h"
#include "station/documents/gate_list.h"
#include "tests/station/serve/technician_page_fixture.h"

namespace station_test {
namespace {

constexpr double kSecondsOfAnAction = 30;  // to exchange what stands on the platform, or to move the lamp

double seconds_of_utc(const std::string& utc) {
  std::tm parts{};
  strptime(utc.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  return static_cast<double>(timegm(&parts));
}

// With light by which lit targets are exposed for about a second.
class DimLight : public TechnicianPage {
 protected:
  DimLight()
      : TechnicianPage({{"operator", "console"},
                        {"simulation", {{"lamp", {{"intensity_mm2", {424115.0, 530143.0, 381703.0}}}}}}}) {
    post("/api/control", {{"client", "me"}});
  }
};

TEST_F(DimLight, IsCalibratedByTwelveActionsInAQuarterOfAnHour) {
  const std::vector<std::string> asked = attend({{"client", "me"}, {"kind", "calibrate"}, {"name", "monday"}});
  EXPECT_LE(asked.size(), 12U);
  for (const std::string& text : asked) EXPECT_EQ(text.find("degrees to the"), std::string::npos) << text;

  const std::filesystem::path folder = folder_.path() / "bench/calibrations/monday";
  const json pictures = station::read_json_file(folder / "pictures.json").at("pictures");
  double first = 1e18, last = 0, panel_s = 0, panels = 0;
  for (const json& picture : pictures) {
    const double began = seconds_of_utc(picture.at("utc")), exposure_s = picture.at("exposure_s");
    first = std::min(first, began), last = std::max(last, began + exposure_s);
    if (picture.at("role") == "front_light") panel_s += exposure_s, panels += 1;
  }
  const double minutes = (last - first + kSecondsOfAnAction * static_cast<double>(asked.size())) / 60;
  std::printf("%zu actions, %zu pictures, %.1f minutes at %.0f s an action; the panel is exposed for %.2f s\n",
              asked.size(), pictures.size(), minutes, kSecondsOfAnAction, panel_s / panels);
  EXPECT_NEAR(panel_s / panels, 1, 0.3);
  EXPECT_LE(minutes, 15);
  EXPECT_EQ(station::failed_gates(station::all_gates(station::read_calibration(folder))), "");
}

}  // namespace
}  // namespace station_test
