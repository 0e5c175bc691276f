// The commands about a rig's devices, run as a person runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/station/commands/simulated_hardware.h"

namespace {

using nlohmann::json;
using station_test::ProgramResult;
using station_test::run_threadstation;
using testing::HasSubstr;

std::string fixture(const std::string& name) {
  return std::string(DATA_DIR) + "/rigs/" + name + ".json";
}

void expect_refused(const ProgramResult& result, const std::string& words) {
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.error_lines(), 1) << result.error;
  EXPECT_THAT(result.error, HasSubstr(words));
}

struct RigCommands : testing::Test {
  std::string rig_file(const json& document) const {
    station::write_json_file(folder / "rig.json", document);
    return folder / "rig.json";
  }
  station_test::TemporaryFolder folder;
};

}  // namespace

TEST_F(RigCommands, CheckEndsInATableForEverySimulatedRig) {
  for (const char* name : {"simulated", "simulated_wire_grbl", "simulated_wire_zaber"}) {
    const ProgramResult result = run_threadstation({"check", "--rig", fixture(name)});
    EXPECT_EQ(result.status, 0) << result.error << result.out;
    EXPECT_THAT(result.out, HasSubstr("  ok    moves are reached and read back"));
    EXPECT_THAT(result.out, HasSubstr("  ok    each picture is a new one"));
    EXPECT_THAT(result.out, testing::Not(HasSubstr("FAIL")));
  }
}

TEST_F(RigCommands, CheckPassesForACameraOfEveryMakeAndForALensWithoutAnElectronicAperture) {
  for (const char* make : {"sony", "canon", "nikon"}) {
    json rig = station::read_json_file(fixture("simulated_wire_grbl"));
    rig["simulation"]["make"] = make;
    rig["simulation"]["lens"]["electronic_aperture"] = false;
    const ProgramResult result = run_threadstation({"check", "--rig", rig_file(rig)});
    EXPECT_EQ(result.status, 0) << make << result.error << result.out;
    EXPECT_THAT(result.out, HasSubstr("  ok    a picture has bytes, a date and the settings asked"));
  }
}

TEST_F(RigCommands, CheckWithACalibrationLooksAtATestPicture) {
  json rig = station::read_json_file(fixture("simulated"));
  rig["simulation"]["target_samples_per_pixel"] = 4;
  const std::string calibration = std::string(DATA_DIR) + "/calibrations/simulated.json";
  const ProgramResult sound = run_threadstation({"check", "--rig", rig_file(rig), "--calibration", calibration});
  EXPECT_EQ(sound.status, 0) << sound.error << sound.out;
  for (const char* row : {"an exposure is found", "the picture is in focus", "tags on the platform are seen",
                          "tags on the table are seen", "the bench stands as it was calibrated"})
    EXPECT_THAT(sound.out, HasSubstr(std::string("  ok    ") + row));
  rig["simulation"]["lens"]["blur_px"] = 2.5;
  const ProgramResult blurred = run_threadstation({"check", "--rig", rig_file(rig), "--calibration", calibration});
  expect_refused(blurred, "the test picture failed \"the picture is in focus\": edges of tags are");
}

TEST_F(RigCommands, CheckSaysInOneLineWhatIsMissing) {
  json rig = station::read_json_file(fixture("grbl_sony_network"));
  rig["turntable_setup"]["port"] = "/dev/ttyNONE7";
  rig["camera_connection"]["port"] = "ptpip:127.0.0.1:9:9";
  const ProgramResult result = run_threadstation({"check", "--rig", rig_file(rig)});
  expect_refused(result, "there is no port /dev/ttyNONE7; plug the turntable in");
  EXPECT_THAT(result.out, HasSubstr("camera (gphoto2 at ptpip:127.0.0.1:9:9)"));
  EXPECT_THAT(result.out, HasSubstr("check its cable and battery"));
}

TEST_F(RigCommands, CheckAsJsonIsForMachines) {
  const ProgramResult result = run_threadstation({"check", "--json", "--rig", fixture("simulated")});
  const json checks = json::parse(result.out);
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[0]["device"], "turntable (simulated)");
  EXPECT_EQ(checks[0]["passed"], true);
}

TEST_F(RigCommands, AFaultThatThereIsNotIsNamedWithThoseThatThereAre) {
  json faults = station::read_json_file(std::string(DATA_DIR) + "/faults/example.json");
  faults["camera"][0]["fault"] = "hiccup";
  station::write_json_file(folder / "faults.json", faults);
  expect_refused(run_threadstation({"simulate-hardware", "--rig", fixture("simulated_wire_grbl"), "--faults",
                                    folder / "faults.json"}),
                 "\"hiccup\" is none; it is one of silence, lost_answer, cut");
}

TEST_F(RigCommands, SimulateHardwareNeedsSomethingOnAWire) {
  expect_refused(run_threadstation({"simulate-hardware", "--rig", fixture("simulated")}),
                 "names nothing that is simulated on a wire");
}

TEST_F(RigCommands, TurntableSetUpShowsTheSettingsOfASimulatedController) {
  const ProgramResult result = run_threadstation({"turntable", "set-up", "--rig", fixture("simulated_wire_grbl")});
  EXPECT_EQ(result.status, 0) << result.error;
  EXPECT_THAT(result.out, HasSubstr("Grbl 1.1h"));
  EXPECT_THAT(result.out, HasSubstr("  right    $100  steps per degree"));
  EXPECT_THAT(result.out, HasSubstr("nothing had to be changed"));
  EXPECT_THAT(result.out, testing::Not(HasSubstr("DIFFERS")));
}

TEST_F(RigCommands, TurntableSetUpSaysInOneLineWhereItHasNothingToDo) {
  expect_refused(run_threadstation({"turntable", "set-up", "--rig", fixture("simulated_wire_zaber")}),
                 "has a Zaber stage, which needs no such set-up");
  expect_refused(run_threadstation({"turntable", "set-up", "--rig", fixture("manual_sony_usb")}), "(manual)");
  expect_refused(run_threadstation({"turntable", "set-up", "--rig", fixture("simulated_wire_grbl"), "--write"}),
                 "--write needs --back-up FILE");
}

// The controller is set to 40 steps per degree and the rig file says 50.
TEST_F(RigCommands, TurntableSetUpWritesWhatDiffersAndPutsItBack) {
  const std::string ports = folder / "ports", program = THREADSTATION_PROGRAM, back_up = folder / "before.json";
  const ProgramResult started = station_test::run_shell(
      program + " simulate-hardware --json --rig " + fixture("simulated_wire_grbl") + " > " + ports +
      " & echo $!; while [ ! -s " + ports + " ]; do kill -0 $! || exit 1; sleep 0.05; done");
  ASSERT_EQ(started.status, 0) << started.error;
  json rig = station::read_json_file(fixture("grbl_sony_network"));
  rig["turntable_setup"]["line"] = "pty";
  rig["turntable_setup"].erase("baud");
  rig["turntable_setup"]["port"] = station::read_json_file(ports)["turntable"]["port"];
  rig["turntable_setup"]["steps_per_deg"] = 50;
  const std::vector<std::string> set_up{"turntable", "set-up", "--rig", rig_file(rig)};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = set_up;
    all.insert(all.end(), more.begin(), more.end());
    return run_threadstation(all);
  };
  expect_refused(run_threadstation({"check", "--rig", rig_file(rig)}), "type: $100=50");
  EXPECT_THAT(with({}).out, HasSubstr("type: $100=50"));
  EXPECT_THAT(with({"--write", "--back-up", back_up}).out, HasSubstr("40 -> 50"));
  EXPECT_THAT(with({}).out, HasSubstr("nothing had to be changed"));
  const json restored = json::parse(with({"--restore", back_up, "--json"}).out);
  for (const json& row : restored["settings"])
    if (row["number"] == 100) EXPECT_EQ(row["after"], 40);
  EXPECT_EQ(station_test::run_shell("kill -INT " + started.out).status, 0);
}

// Two programs: one is the hardware with faults, the other one finds it at the ports that the first one printed.
TEST_F(RigCommands, SimulatedHardwareServesAnotherProgramAndEndsWithCtrlC) {
  json wire = station::read_json_file(fixture("simulated_wire_grbl"));
  wire["simulation"]["turntable"]["speed_deg_s"] = 300;  // in real time
  const std::string faults = std::string(DATA_DIR) + "/faults/example.json";
  const station_test::SimulatedHardware hardware(wire, faults);
  json rig = station::read_json_file(fixture("grbl_sony_network"));
  rig["turntable_setup"]["line"] = "pty";
  rig["turntable_setup"]["home"] = "switch";
  rig["turntable_setup"].erase("baud");
  rig["turntable_setup"]["port"] = hardware.turntable_port();
  rig["camera_connection"]["port"] = hardware.camera_port();
  const ProgramResult result = run_threadstation({"check", "--rig", rig_file(rig)});
  EXPECT_EQ(result.status, 0) << result.error << result.out;
}
