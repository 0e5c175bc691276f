// The guided calibration at the level of pictures, on two whole benches: what it finds against what is true there. One
// table with all figures is printed.

#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "station/bench/calibrate/calibration_pictures.h"
#include "station/bench/calibration_validity.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/bench/calibrate/calibration_errors.h"
#include "tests/station/commands/workflow.h"

namespace station_test {
namespace {

using nlohmann::json;
using station::CalibrationRole;

// Drawn with a quarter of the documented samples: whatever is found in such pictures is found in better ones.
json documented_rig() {
  json rig = station::read_json_file(std::string(DATA_DIR) + "/rigs/simulated.json");
  rig["simulation"]["target_samples_per_pixel"] = 4;
  return rig;
}

// Everything that calibration has to find is another; what is known by tape and by the lens's engraving stays.
json other_rig() {
  json rig = documented_rig();
  json& truth = rig["simulation"];
  truth["seed"] = 23;
  truth["lens"]["focal_length_px"] = {2421, 2418};
  truth["lens"]["principal_point_px"] = {296.1, 203.2};
  truth["lens"]["distortion"] = {-0.2, 0.6, -0.0003, 0.0005, 0};
  truth["lens"]["vignetting"] = {-0.11, -0.02};
  truth["sensor"]["full_well_e"] = 41000;
  truth["sensor"]["defects"]["nonlinearity"] = 0.005;
  truth["turntable"]["scale"] = 0.9971;
  truth["lamp"]["front_position_mm"] = {338.2, 98.3, 383.1};
  truth["lamp"]["back_position_mm"] = {-352.0, 104.0, 312.5};
  truth["lamp"]["beam_exponent"] = 0.6;
  truth["lamp"]["changes"]["drift_per_s"] = -2e-5;
  truth["spectralon_droop_percent"] = 14;
  truth["board_bow_mm"] = -0.5;
  return rig;
}

// Mean of the lamp's true strength while the panel was photographed; its clock started with the first picture.
double strength_at_the_panel(const std::filesystem::path& folder, const rig::LampChanges& changes) {
  const auto pictures = station::read_calibration_pictures(folder);
  double sum = 0, count = 0;
  for (const station::CalibrationPicture& picture : pictures) {
    if (picture.role != CalibrationRole::front_light && picture.role != CalibrationRole::back_light) continue;
    const double begin_s = 86400 * station::days_between(pictures.front().utc, picture.utc);
    sum += lamp_strength(changes, begin_s, picture.exposure_s);
    ++count;
  }
  return sum / count;
}

void expect_found_as_it_is(const std::string& name, const json& rig) {
  const TemporaryFolder folder;
  station::write_json_file(folder / "rig.json", rig);
  expect_success(
      run_threadstation({"calibrate", "--rig", folder / "rig.json", "--out", folder / "calibration", "--quiet"}));
  const station::SimulatedRig bench = *station::read_rig(folder / "rig.json").simulation;
  const CalibrationErrors errors =
      calibration_errors(station::read_calibration(folder / "calibration"), bench,
                         strength_at_the_panel(folder / "calibration", bench.truth.lamp_changes));
  std::printf("%s%s", heading().c_str(), row(name, errors).c_str());
  EXPECT_LT(errors.lens_px, 0.3 / 8400 * bench.truth.lens.fx_px);  // the angle that is 0.3 px on 24 megapixels
  EXPECT_LT(errors.axis_deg, 0.01);                                // where the fit looks for the threads
  EXPECT_LT(errors.axis_across_mm, 0.05);
  EXPECT_LT(errors.axis_along_mm, 0.2);
  EXPECT_LT(errors.lamp_mm[0], 2.5);       // asked as the rms of many benches; 5 mm at worst
  EXPECT_LT(errors.lamp_mm[1], 5);         // farther from the panel's face and seen at steeper angles
  EXPECT_LT(errors.irradiance[0], 0.005);  // what a thread's brightness may be off by for its lamp
  EXPECT_LT(errors.irradiance[1], 0.01);
  for (const double held_out : errors.held_out) EXPECT_LT(held_out, 0.005);  // its own gate, with the lamp's drift read
  EXPECT_LT(errors.angle_deg, 0.02);                                         // less than the turntable's step of 0.025
  EXPECT_LT(errors.gain, 0.01);  // variances, and with them weights, are off by as much
  EXPECT_LT(errors.linearity, 0.002);
}

TEST(WholeBenches, TheDocumentedBenchIsFoundAsItIs) {
  expect_found_as_it_is("documented", documented_rig());
}

TEST(WholeBenches, AnotherBenchIsFoundAsItIs) {
  expect_found_as_it_is("other", other_rig());
}

}  // namespace
}  // namespace station_test
