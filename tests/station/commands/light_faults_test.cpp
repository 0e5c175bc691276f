// Faults of the lamp and the Spectralon panel while a rig is calibrated: each is refused in one line that says which
// picture and what to do, or the calibration is solved all the same.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "calibration/sensor/sensor_file.h"
#include "station/bench/bench_picture.h"
#include "station/bench/calibrate/calibration_plan.h"
#include "station/documents/calibration_file.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/reader.h"
#include "tests/station/commands/workflow.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using station::CalibrationRole;

class LightFaults : public Workflow {
 protected:
  // A copy of the calibration without its solution.
  static std::string copy(const std::string& name) {
    fs::copy(path("calibration"), path(name), fs::copy_options::recursive);
    fs::remove(path(name) + "/calibration.json");
    return path(name);
  }

  // Takes some of its pictures again, with the exposure they had, on a bench on which `change` has been made.
  static void take_again(const std::string& folder, const std::vector<std::string>& ids,
                         const std::function<void(rig::BenchState&)>& change) {
    const station::RigFile rig = station::read_rig(path("rig.json"));
    const rig::DrawPicture draw = station::make_bench_picture(rig, std::nullopt);
    rig::SimulatedBench bench(rig.simulation->truth, [&](const rig::BenchState& state) {
      rig::BenchState changed = state;
      change(changed);
      return draw(changed);
    });
    rig::SimulatedClock clock(1.8e9);
    const auto camera = rig::make_simulated_camera(bench, clock);
    json list = station::read_json_file(folder + "/pictures.json");
    for (const station::CalibrationStep& step : station::make_calibration_plan(rig))
      for (json& entry : list["pictures"]) {
        if (entry["id"] != step.id || std::find(ids.begin(), ids.end(), step.id) == ids.end()) continue;
        const fs::path file = fs::path(folder) / entry["file"].get<std::string>();
        bench.place(step.arrangement);
        bench.turn_platform(entry["reading_deg"].get<double>() * station::kDegree *
                            rig.simulation->truth.turntable.scale);
        camera->configure({.exposure_s = calibration::read_sensor_file(file).exposure_s});
        const rig::Picture picture = camera->capture();
        std::ofstream(file, std::ios::binary)
            .write(reinterpret_cast<const char*>(picture.bytes.data()),
                   static_cast<std::streamsize>(picture.bytes.size()));
        entry["sha256"] = station::sha256_of_file(file);
      }
    station::write_json_file(folder + "/pictures.json", list);
  }

  static ProgramResult solve(const std::string& folder, const std::string& rig = "rig.json") {
    return run_threadstation({"calibrate", "--rig", path(rig), "--out", folder, "--solve", "--quiet"});
  }
};

TEST_F(LightFaults, TheLampIsOffInOnePicture) {
  const std::string folder = copy("lamp_off");
  take_again(folder, {"front_light-05"}, [](rig::BenchState& state) { state.lamp.reset(); });
  const ProgramResult result = solve(folder);
  expect_one_line(result, "front_light-05 is dark");
  EXPECT_NE(result.error.find("switch the lamp on"), std::string::npos) << result.error;
}

TEST_F(LightFaults, TheRoomLightIsOnInSomePictures) {
  const std::string folder = copy("room_light");
  const Eigen::Vector3d room = station::read_rig(path("rig.json")).simulation->truth.room_radiance;
  take_again(folder, {"front_light-03", "back_light-02"}, [&](rig::BenchState& state) { state.room_radiance = room; });
  expect_one_line(solve(folder), "front_light-03, back_light-02: off in brightness");
}

TEST_F(LightFaults, TheRoomLightIsOnInAllPicturesOfTheFrontLamp) {
  const std::string folder = copy("room_light_always");
  const Eigen::Vector3d room = station::read_rig(path("rig.json")).simulation->truth.room_radiance;
  std::vector<std::string> all;
  const json list = station::read_json_file(folder + "/pictures.json");
  for (const json& entry : list["pictures"]) all.push_back(entry["id"]);
  std::erase_if(all, [](const std::string& id) { return !id.starts_with("front_light"); });
  take_again(folder, all, [&](rig::BenchState& state) { state.room_radiance = room; });
  const ProgramResult result = solve(folder);
  expect_one_line(result, "panel pictures under the front lamp are predicted from the others");
  EXPECT_NE(result.error.find("switch the room light off"), std::string::npos) << result.error;
}

// The documented lamp burns on constant current; this one's driver switches it, and an exposure lasts only a dozen
// periods.
TEST_F(LightFaults, ALampThatIsSwitchedOnAndOffIsRefusedForItsFlicker) {
  const std::string folder = copy("switched");
  json rig = station::read_json_file(path("rig.json"));
  rig["simulation"]["target_samples_per_pixel"] = 1;
  rig["simulation"]["lamp"]["changes"]["pwm_hz"] = 103;
  rig["simulation"]["lamp"]["changes"]["pwm_duty"] = 0.5;
  station::write_json_file(path("switched_rig.json"), rig);
  const ProgramResult result = run_threadstation(
      {"calibrate", "--rig", path("switched_rig.json"), "--out", folder, "--only", "response", "--quiet"});
  expect_one_line(result, "lamp's flicker from picture to picture");
  EXPECT_NE(result.error.find("20 of the lamp's switching periods"), std::string::npos) << result.error;
}

TEST_F(LightFaults, TheLampIsMovedBetweenPictures) {
  const std::string folder = copy("lamp_moved");
  take_again(folder, {"front_light-07", "front_light-08", "front_light-09", "front_light-10"},
             [](rig::BenchState& state) {
               if (state.lamp) state.lamp->position += Eigen::Vector3d(0, 30, -20);
             });
  expect_one_line(solve(folder), "front lamp");
}

TEST_F(LightFaults, OnePoseIsNotEnough) {
  const std::string folder = copy("one_pose");
  json list = station::read_json_file(folder + "/pictures.json"), kept = json::array();
  for (const json& entry : list["pictures"])
    if (entry["role"] != "front_light" || entry["id"] == "front_light-01") kept.push_back(entry);
  list["pictures"] = kept;
  station::write_json_file(folder + "/pictures.json", list);
  expect_one_line(solve(folder), "under the front lamp the panel was seen in one direction only");
}

TEST_F(LightFaults, ATapeThatIsTenCentimetresWrongDoesNotMatter) {
  const std::string folder = copy("tape");
  json rig = station::read_json_file(path("rig.json"));
  rig["lamp_by_tape"]["front_position_mm"] = {390, 47, 426};
  station::write_json_file(path("wrong_tape.json"), rig);
  expect_success(solve(folder, "wrong_tape.json"));
  const station::RigCalibration right = station::read_calibration(path("calibration")),
                                found = station::read_calibration(folder);
  EXPECT_LT((found.light.positions[0] - right.light.positions[0]).norm(), 1);
}

TEST_F(LightFaults, ALampThatDimsIsCorrectedByTheReadingOfAReferenceChip) {
  const std::string folder = copy("dimmed");
  take_again(folder, {"front_light-04"}, [](rig::BenchState& state) {
    if (state.lamp) state.lamp->intensity *= 0.95;
  });
  expect_one_line(solve(folder), "front_light-04: off in brightness");
  json list = station::read_json_file(folder + "/pictures.json");
  for (json& entry : list["pictures"])
    if (entry["role"] == "front_light") entry["lamp_output"] = entry["id"] == "front_light-04" ? 0.95 : 1.0;
  station::write_json_file(folder + "/pictures.json", list);
  expect_success(solve(folder));
}

}  // namespace
}  // namespace station_test
