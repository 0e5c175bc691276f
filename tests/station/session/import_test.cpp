// Pictures taken by hand become a session: here those of the recorded session, listed as a person would.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "rig/simulated/raw_writer.h"
#include "station/documents/plan_file.h"
#include "station/documents/reader.h"
#include "station/session/develop/develop_session.h"
#include "station/session/import_session.h"
#include "tests/places.h"
#include "tests/station/session/recorded_bench.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

struct Import : testing::Test {
  Import() {
    const json session = read_json_file(recorded_session() / "session.json");
    write_json_file(folder / "rig.json", session.at("rig"));
    write_json_file(folder / "spool.json", session.at("spool"));
    list = {{"format", "threadstation/import"},
            {"version", 1},
            {"rig", "rig.json"},
            {"spool", "spool.json"},
            {"operator", "Ada"},
            {"calibration", (recorded_session() / "calibration").string()}};
    list["pictures"] = json::array();
    for (const auto& [step, picture] : pictures_of(recorded_session())) {
      if (!picture.same_as.empty()) continue;
      json entry = {{"file", (recorded_session() / picture.file).string()}, {"kind", kind_name(picture.kind)}};
      if (picture.kind != StepKind::dark) {
        entry["mounting"] = mounting_name(picture.mounting);
        entry["platform_angle_deg"] = file_degrees(picture.read_angle_rad);
      }
      if (picture.kind == StepKind::view) entry["lamp"] = lamp_name(picture.lamp);
      list["pictures"].push_back(entry);
    }
  }
  RunState import(const std::string& name) {
    write_json_file(folder / "list.json", list);
    return import_session(folder / "list.json", {.session = folder / name, .progress_style = ProgressStyle::quiet});
  }
  std::string refusal() {
    return message_of([&] { import("refused"); });
  }
  TemporaryFolder folder;
  json list;
};

TEST_F(Import, TheSessionVerifiesAndDevelopsToTheSameViews) {
  ASSERT_EQ(import("session"), RunState::complete);
  EXPECT_TRUE(verify_session(folder / "session").sound());
  EXPECT_EQ(read_session_file(folder / "session").person, "Ada");
  const DevelopedViews developed = develop_session(folder / "session", ProgressStyle::quiet);
  EXPECT_EQ(developed.views.size(), 17U);
  fs::copy(recorded_session(), folder / "recorded", fs::copy_options::recursive);
  const DevelopedViews recorded = develop_session(folder / "recorded", ProgressStyle::quiet);
  for (const DevelopedView& view : recorded.views) {
    const auto same = std::ranges::find_if(developed.views, [&](const DevelopedView& other) {
      return other.mounting == view.mounting && other.view.transmission == view.view.transmission &&
             std::abs(other.platform_angle_rad - view.platform_angle_rad) < 1e-3;
    });
    ASSERT_NE(same, developed.views.end()) << view.view.id;
    EXPECT_EQ(same->masked_pixels, view.masked_pixels) << view.view.id;
  }
}

TEST_F(Import, WithoutACalibrationTheRigsTapeSaysWhereThingsStand) {
  list.erase("calibration");
  EXPECT_THAT(refusal(), HasSubstr("lamp_intensity_mm2"));
  list["lamp_intensity_mm2"] = {2.5e6, 3.2e6, 2.3e6};
  json views = json::array();  // as in a session without any printed tag: views alone
  for (const json& picture : list["pictures"])
    if (picture["kind"] == "view") views.push_back(picture);
  list["pictures"] = views;
  json rig = read_json_file(folder / "rig.json");
  rig.erase("reference_patch");
  write_json_file(folder / "rig.json", rig);
  ASSERT_EQ(import("by_tape"), RunState::complete);
  const RigCalibration calibration = read_calibration(folder / "by_tape/calibration");
  EXPECT_FALSE(calibration::all_passed(all_gates(calibration)));
  EXPECT_TRUE(verify_session(folder / "by_tape").sound());
}

// The same mosaic in a file that also says how long the lens was.
fs::path with_focal_length(const fs::path& file, double focal_length_mm, const fs::path& to) {
  const calibration::SensorPicture picture = calibration::read_sensor_file(file);
  const std::vector<std::byte> bytes = rig::encode_raw({.mosaic = picture.mosaic,
                                                        .settings = {picture.exposure_s, picture.iso, picture.f_number},
                                                        .utc = "2026-11-21T10:20:30.000Z",
                                                        .serial = picture.serial,
                                                        .focal_length_mm = focal_length_mm});
  write_text(to, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return to;
}

TEST_F(Import, WithoutALensFileTheFocalLengthIsThatOfExifElseTheEngravedOne) {
  const fs::path said = recorded_session() / "raw/reflection-horizontal-1.arw";
  const RigFile rig = read_rig(folder / "rig.json");
  const ImportFile import{.lamp_intensity_mm2 = Eigen::Vector3d(1, 1, 1)};
  const auto by_tape = [&](const fs::path& file) {
    return calibration_by_tape(rig, import, calibration::read_sensor_file(file), "2026-11-21T10:20:30.000Z");
  };
  const RigCalibration engraved = by_tape(said);
  EXPECT_EQ(engraved.lens.lens.fx_px, rig.focal_length_guess_px);
  EXPECT_THAT(engraved.light.gates.at(0).reason, HasSubstr("focal_length_guess_px"));
  const RigCalibration exif = by_tape(with_focal_length(said, 135, folder / "135.arw"));
  EXPECT_NEAR(exif.lens.lens.fx_px, 135 * std::hypot(300, 200) / std::hypot(36, 24), 1e-9);
  EXPECT_THAT(exif.light.gates.at(0).reason, HasSubstr("EXIF, 135"));
}

TEST_F(Import, TheDocumentedListIsRead) {
  const ImportFile documented = read_import_file(fs::path(FIXTURES_DIR) / "imports/silk_red_by_hand.json");
  EXPECT_EQ(std::ranges::count(documented.pictures, StepKind::view, &ImportedPicture::kind), 17);
  EXPECT_EQ(read_rig(documented.rig).name, read_session_file(recorded_session()).rig.name);
}

TEST_F(Import, WrongListsAreOneLine) {
  const json whole = list;
  list["pictures"][0]["file"] = "nowhere.arw";
  EXPECT_THAT(refusal(), HasSubstr("nowhere.arw"));
  list = whole;
  list["pictures"][0]["light"] = "left";
  EXPECT_THAT(refusal(), HasSubstr("light"));
  list = whole;
  list["pictures"] = json::array();
  EXPECT_THAT(refusal(), HasSubstr("no view"));
  EXPECT_FALSE(fs::exists(folder / "refused"));
}

}  // namespace
}  // namespace station
