// `rig new` and `rig check` as a person runs them, on the simulated bench: on the wire, and with a platform that is
// turned by hand. The file that they begin from is wrong in all that the pictures tell: focal length, the camera's
// place, what it looks at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>

#include "station/documents/commented_json.h"
#include "station/documents/reader.h"
#include "station/documents/rig_file.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string ready(const std::string& name) {
  return std::string(DATA_DIR) + "/rigs/" + name + ".json";
}

json wrong_rig(const std::string& turntable) {
  json rig = station::read_json_file(ready("simulated_wire_" + std::string(turntable == "zaber" ? "zaber" : "grbl")));
  if (turntable == "manual") {
    rig["turntable"] = "manual";
    rig.erase("turntable_setup");
  }
  rig["operator"] = "console";
  rig["focal_length_guess_px"] = 9000;
  rig["camera_by_tape"] = {{"position_mm", {900, 0, 200}}, {"aim_mm", {0, 0, 0}}};
  rig["simulation"]["target_samples_per_pixel"] = 3;
  return rig;
}

class RigNew : public testing::Test {
 protected:
  // Makes `out` from a rig like `rig`; each line is typed, then Enter as often as there are questions.
  ProgramResult make(const json& rig, const std::string& typed, const std::string& more = "yes ''") {
    station::write_json_file(folder_ / "like.json", rig);
    return run_shell("(printf '" + typed + "'; " + more + ") | " + THREADSTATION_PROGRAM + " rig new --like " +
                     (folder_ / "like.json").string() + " --out " + out());
  }
  std::string out() const { return folder_ / "rig.json"; }

  TemporaryFolder folder_;
};

class RigNewOnEachTurntable : public RigNew, public testing::WithParamInterface<std::string> {};

TEST_P(RigNewOnEachTurntable, MeasuresTheBenchAndWritesAFileThatIsAccepted) {
  const json wrong = wrong_rig(GetParam());
  const ProgramResult made = make(wrong, "Bench three\\n\\n\\n\\n\\n\\n330, 107, 376\\n-345,97,324\\n\\n0.98\\n");
  ASSERT_EQ(made.status, 0) << made.error << made.out;
  const station::RigFile rig = station::read_rig(out());
  EXPECT_EQ(rig.name, "Bench three");
  EXPECT_EQ(rig.front_lamp_mm, Eigen::Vector3d(330, 107, 376));
  EXPECT_EQ(rig.back_lamp_mm, Eigen::Vector3d(-345, 97, 324));
  EXPECT_EQ(rig.spectralon.albedo, 0.98);
  const rig::TrueLens& truth = rig.simulation->truth.lens;
  EXPECT_NEAR(rig.focal_length_guess_px / truth.fx_px, 1, 0.03);
  EXPECT_LT((rig.world_from_camera_by_tape.translation() - truth.world_from_camera.translation()).norm(), 15);
  EXPECT_LT(rig.world_from_camera_by_tape.rotation().col(2).cross(truth.world_from_camera.rotation().col(2)).norm(),
            0.02);
  EXPECT_THAT(made.out, HasSubstr("turns counter-clockwise, as it should, by 1.00"));
  const ProgramResult reviewed = run_threadstation({"rig", "check", out()});
  EXPECT_EQ(reviewed.status, 0) << reviewed.out;
  if (GetParam() == "manual") return;  // it is turned by nobody here
  const ProgramResult checked = run_threadstation({"check", "--rig", out()});
  EXPECT_EQ(checked.status, 0) << checked.error << checked.out;
}
INSTANTIATE_TEST_SUITE_P(Each, RigNewOnEachTurntable, testing::Values("grbl", "zaber", "manual"));

TEST_F(RigNew, EveryKeyOfTheFileIsExplainedAboveIt) {
  ASSERT_EQ(make(wrong_rig("grbl"), "").status, 0);
  std::ifstream lines(out());
  std::string before;
  int keys = 0;
  for (std::string line; std::getline(lines, line); before = line) {
    if (!std::regex_search(line, std::regex("^  \""))) continue;
    ++keys;
    EXPECT_THAT(before, testing::StartsWith("  // ")) << line;
  }
  EXPECT_GT(keys, 20);
}

TEST_F(RigNew, AnswersOutliveAnInterviewThatBrokeOff) {
  const ProgramResult broken = make(wrong_rig("grbl"), "Bench three\\n", "true");
  EXPECT_EQ(broken.status, 1);
  EXPECT_EQ(broken.error_lines(), 1) << broken.error;
  EXPECT_THAT(broken.error, HasSubstr("the input ended before anybody answered"));
  const ProgramResult made = make(wrong_rig("grbl"), "");
  EXPECT_EQ(made.status, 0) << made.error;
  EXPECT_THAT(made.out, HasSubstr("Went on from what was answered before"));
  EXPECT_EQ(station::read_rig(out()).name, "Bench three");
  EXPECT_FALSE(std::filesystem::exists(out() + ".draft"));
  const ProgramResult again = make(wrong_rig("grbl"), "");
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.error, HasSubstr("is there already"));
}

TEST_F(RigNew, WhatCannotBeIsAskedAgainWithTheReason) {
  const ProgramResult made = make(wrong_rig("grbl"), "\\n\\n\\n70\\nlong\\n99,5\\n");
  EXPECT_EQ(made.status, 0) << made.error;
  EXPECT_THAT(made.out, HasSubstr("\"70\" cannot be taken: expected a number from 80.00 to 125.00"));
  EXPECT_THAT(made.out, HasSubstr("\"long\" cannot be taken"));
  EXPECT_EQ(station::read_rig(out()).control_bar_mm, 99.5);
}

TEST_F(RigNew, APlatformThatTurnsFurtherThanToldGetsItsStepsCorrected) {
  json rig = wrong_rig("grbl");
  rig["simulation"]["turntable"]["scale"] = 1.25;
  const ProgramResult made = make(rig, "");
  ASSERT_EQ(made.status, 0) << made.error;
  EXPECT_THAT(made.out, HasSubstr("Told to turn by 1 degree, the platform turns by 1.25"));
  EXPECT_NEAR(station::read_rig(out()).turntable_wire->controller.steps_per_deg, 32, 0.1);
}

TEST_F(RigNew, APlatformOutOfThePictureIsSaid) {
  json rig = wrong_rig("grbl");
  rig["simulation"]["lens"]["aim_mm"] = {0, 600, 64};
  const ProgramResult made = make(rig, "");
  EXPECT_EQ(made.status, 1);
  EXPECT_THAT(made.error, HasSubstr("with the platform at 0 degrees 0 of the 12 tags on the platform are seen"));
}

TEST(RigCheck, EveryReadyRigIsWithoutFaultButForThePlaceholderOfItsPort) {
  for (const char* name : {"simulated", "simulated_wire_grbl", "simulated_wire_zaber", "manual_sony_usb",
                           "zaber_sony_usb", "grbl_sony_network"}) {
    const ProgramResult result = run_threadstation({"rig", "check", ready(name)});
    EXPECT_EQ(result.status, 0) << name << result.out;
  }
  const ProgramResult example = run_threadstation({"rig", "check", ready("grbl_sony_usb")});
  EXPECT_EQ(example.status, 1);
  EXPECT_THAT(example.out, HasSubstr("MEND  turntable_setup.usb_serial is that of the example"));
}

TEST(RigCheck, AllFaultsAreSaidAtOnceEachWithWhatTheKeyMeans) {
  const TemporaryFolder folder;
  json rig = station::read_json_file(ready("manual_sony_usb"));
  rig.erase("camera_by_tape");
  rig["board"]["rows"] = "three";
  rig["coulour_chart"] = 1;
  rig["lamp_by_tape"]["back_position_mm"] = {345, 97, 324};
  rig["platform"].erase("height_mm");
  station::write_json_file(folder / "rig.json", rig);
  const ProgramResult result = run_threadstation({"rig", "check", folder / "rig.json"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.error_lines(), 1) << result.error;
  for (const char* part : {"\"camera_by_tape\": is missing; add it (camera_by_tape: roughly where the camera stands",
                           "\"board.rows\": found \"three\"", "unknown key \"coulour_chart\"",
                           "\"platform.height_mm\": is missing", "The lamp behind stands before the platform's axis"})
    EXPECT_THAT(result.out, HasSubstr(part));
  EXPECT_THAT(result.error, HasSubstr("has 5 faults"));
}

TEST(RigCheck, APlaceWhereNothingCanBeSeenIsAFault) {
  const TemporaryFolder folder;
  json rig = station::read_json_file(ready("manual_sony_usb"));
  rig["camera_by_tape"]["aim_mm"] = {0, 900, 64};
  station::write_json_file(folder / "rig.json", rig);
  EXPECT_THAT(run_threadstation({"rig", "check", folder / "rig.json"}).out,
              HasSubstr("the platform is not in the picture"));
  rig["camera_by_tape"]["aim_mm"] = {0, 0, 64};
  rig["focal_length_guess_px"] = 600;
  station::write_json_file(folder / "rig.json", rig);
  EXPECT_THAT(run_threadstation({"rig", "check", folder / "rig.json"}).out,
              HasSubstr("a tag on the platform is 13 px wide"));
}

// The table that comments are taken from names every key that a ready rig has, or the object around it.
TEST(RigKeys, EachKeyOfTheReadyRigsIsInTheTable) {
  const station::KeyMeanings meanings = station::read_key_meanings(std::string(DATA_DIR) + "/rigs/README.md");
  EXPECT_EQ(meanings.at("turntable_setup.usb_serial"), meanings.at("turntable_setup.port"));
  EXPECT_EQ(meanings.at("simulation.placement_deg"), meanings.at("simulation.placement_mm"));
  for (const auto& entry : std::filesystem::directory_iterator(std::string(DATA_DIR) + "/rigs")) {
    if (entry.path().extension() != ".json") continue;
    const json rig = station::read_json_file(entry.path());
    for (const auto& [key, value] : rig.items()) {
      EXPECT_TRUE(meanings.contains(key) || key == "simulation") << entry.path() << ": " << key;
      if (key != "turntable_setup" && key != "camera_connection" && key != "simulation") continue;
      for (const auto& [inner, unused] : value.items()) {
        const std::string name = key + "." + inner;
        EXPECT_TRUE(meanings.contains(name)) << entry.path() << ": " << name;
      }
    }
  }
}

}  // namespace
}  // namespace station_test
