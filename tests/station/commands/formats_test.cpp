// Files as they were in a month of the past, read, developed, fitted and rendered by the program of today, and written
// anew by `upgrade`.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "renderer/picture/image_file.h"
#include "station/documents/migrations.h"
#include "station/documents/reader.h"
#include "station/documents/rig_file.h"
#include "station/documents/views_file.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kFormats = fs::path(FIXTURES_DIR) / "formats";
const fs::path kMonth = kFormats / "2026-11";

std::string kind_of(const json& document) {
  const std::string format = document.at("format"), prefix = "threadstation/";
  return format.substr(prefix.size());
}

// The folder as it was, in a place where it may be changed.
fs::path copy_of(const fs::path& folder, const TemporaryFolder& place) {
  const fs::path copy = place / folder.filename();
  fs::copy(folder, copy, fs::copy_options::recursive);
  return copy;
}

void expect_success(const ProgramResult& said) {
  ASSERT_EQ(said.status, 0) << said.error;
}

TEST(Formats, EachKindHasAFileHereAndThoseOfALaterThreadstationAreRefusedByName) {
  std::set<std::string> kinds;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kFormats)) {
    if (entry.path().extension() != ".json") continue;
    json document = station::read_json_file(entry.path());
    const std::string kind = kind_of(document);
    kinds.insert(kind);
    EXPECT_NO_THROW(station::up_to_date(document, entry.path())) << entry.path();
    document["version"] = station::current_version(kind) + 1;
    try {
      station::ObjectReader(document, "a.json", kind);
      ADD_FAILURE() << kind;
    } catch (const std::runtime_error& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("a.json: made by a later threadstation: " + kind + " version "))
          << error.what();
    }
  }
  kinds.insert("checkpoint");  // is no document but for its first line
  for (const std::string& kind : station::document_kinds()) EXPECT_TRUE(kinds.contains(kind)) << kind;
}

TEST(Formats, ARigOfTheFirstDayIsReadAsWhatItWas) {
  const station::RigFile rig = station::read_rig(kMonth / "first_rig.json");
  EXPECT_EQ(rig.calibration_valid_days, 30);
  EXPECT_TRUE(rig.bracket_stops.empty());
  EXPECT_EQ(rig.platform_ring.tags.size(), 12u);
  const rig::BenchTruth& truth = rig.simulation.value().truth;
  EXPECT_EQ(truth.lens.blur_px, 0);
  EXPECT_EQ(truth.sensor.defects.hot_fraction, 0);
  EXPECT_EQ(truth.front.beam_exponent, 0);
  EXPECT_EQ(truth.lamp_changes.pwm_duty, 1);
  EXPECT_EQ(truth.front.aim, rig.lamp_aim_mm);
}

TEST(Formats, ASessionIsDevelopedAndFittedAndItsThreadRendered) {
  const TemporaryFolder place;
  const std::string session = copy_of(kMonth / "session", place);
  expect_success(run_threadstation({"verify", session}));
  expect_success(run_threadstation({"develop", session, "--quiet"}));
  EXPECT_EQ(station::read_views(session).views.size(), 3u);
  expect_success(run_threadstation({"invert", session, "--paths", "64", "--spp", "4", "--quiet"}));
  const json thread = station::read_json_file(session + "/result/thread.json");
  EXPECT_EQ(kind_of(thread), "thread");
  EXPECT_LT(thread.at("fit").at("relative_rmse"), 0.2) << "coarsely";
  const fs::path scenes = copy_of(kMonth, place);
  fs::copy_file(session + "/result/thread.json", scenes / "thread.json", fs::copy_options::overwrite_existing);
  expect_success(run_threadstation({"render", scenes / "scene.json", "--out", place / "a.exr", "--quiet"}));
  EXPECT_GT(cv::mean(renderer::read_exr(place / "a.exr"))[0], 0.01);
}

TEST(Formats, ScenesOfDraftAndPatchAreRendered) {
  const TemporaryFolder place;
  expect_success(run_threadstation({"render", kMonth / "scene.json", "--out", place / "draft.exr", "--quiet"}));
  expect_success(run_threadstation({"render", kMonth / "patch_scene.json", "--out", place / "patch.exr", "--quiet"}));
  for (const char* name : {"draft.exr", "patch.exr"}) EXPECT_GT(cv::mean(renderer::read_exr(place / name))[0], 0.01);
}

TEST(Upgrade, WritesASessionAnewKeepsACopyAndItStillVerifies) {
  const TemporaryFolder place;
  const fs::path session = copy_of(kMonth / "session", place);
  const json before = station::read_json_file(session / "session.json");
  ASSERT_EQ(before.at("rig").at("version"), 1);
  const ProgramResult said = run_threadstation({"upgrade", session, "--json"});
  expect_success(said);
  EXPECT_EQ(json::parse(said.out).size(), 1u) << said.out;
  EXPECT_EQ(station::read_json_file(session / "session.json").at("rig").at("version"), 2);
  EXPECT_EQ(station::read_json_file(session / "before-upgrade" / "session.json"), before);
  expect_success(run_threadstation({"verify", session}));
  const ProgramResult again = run_threadstation({"upgrade", session});
  EXPECT_EQ(again.out, "everything is of this version already\n");
}

TEST(Upgrade, WritesOneFileAnewAndRefusesWhatALaterThreadstationMade) {
  const TemporaryFolder place;
  const fs::path rig = place / "rig.json";
  fs::copy_file(kMonth / "first_rig.json", rig);
  expect_success(run_threadstation({"upgrade", rig}));
  EXPECT_NO_THROW(station::read_rig(rig));
  EXPECT_EQ(station::read_json_file(rig).at("version"), 2);
  EXPECT_EQ(station::read_json_file(place / "before-upgrade" / "rig.json").at("version"), 1);
  json later = station::read_json_file(rig);
  later["version"] = 3;
  station::write_json_file(rig, later);
  const ProgramResult said = run_threadstation({"upgrade", rig});
  EXPECT_EQ(said.status, 1);
  EXPECT_NE(said.error.find("made by a later threadstation: rig version 3"), std::string::npos) << said.error;
  EXPECT_EQ(station::read_json_file(rig), later);
}

}  // namespace
}  // namespace station_test
