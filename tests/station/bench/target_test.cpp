// The target command, as a person types it: what is printed is what the geometry says.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "station/bench/calibrate/standing_target.h"
#include "station/bench/draw_stand.h"
#include "station/bench/print_targets.h"
#include "station/documents/board_file.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

using nlohmann::json;

std::string fixture_rig() {
  return std::string(DATA_DIR) + "/rigs/simulated.json";
}

// Every tag of the page is found where the sheet says, at 300 dots per inch.
void expect_to_scale(const station::TargetSheet& sheet, station::Paper paper, const std::filesystem::path& file) {
  const cv::Mat1b page = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  ASSERT_FALSE(page.empty()) << file;
  constexpr double kPixelsPerMm = 300.0 / 25.4;
  cv::Mat1f grey;
  page.convertTo(grey, CV_32F, 1.0 / 255.0);
  const calibration::TagObservation seen = calibration::detect_tags(grey);
  const Eigen::Vector2d origin = station::origin_on_page_mm(sheet, paper);
  ASSERT_EQ(seen.size(), sheet.tags.size()) << file;
  for (const calibration::TagDetection& found : seen) {
    const auto tag =
        std::find_if(sheet.tags.begin(), sheet.tags.end(), [&](const auto& t) { return t.id == found.id; });
    ASSERT_NE(tag, sheet.tags.end()) << found.id;
    const auto corners = calibration::corners_in_object(*tag);
    for (std::size_t c = 0; c < 4; ++c) {
      const Eigen::Vector2d on_page(origin.x() + corners[c].x(), origin.y() - corners[c].y());
      const Eigen::Vector2d pixel = on_page * kPixelsPerMm - Eigen::Vector2d::Constant(0.5);
      // edges of the picture lie half a pixel before its first pixel's centre; 0.2 px are 0.02 mm
      EXPECT_LT((found.corners_px[c] - pixel).norm(), 0.2) << file << " tag " << found.id;
    }
  }
}

TEST(Target, EveryTagIsDrawnToScaleOnBothPapers) {
  const TemporaryFolder folder;
  for (const auto& [paper, name] : {std::pair{station::Paper::a4, "a4"}, {station::Paper::letter, "letter"}}) {
    const ProgramResult result =
        run_threadstation({"target", "--rig", fixture_rig(), "--out", folder / name, "--paper", name});
    ASSERT_EQ(result.status, 0) << result.error;
    const std::vector<station::TargetSheet> sheets = station::target_sheets(station::read_rig(fixture_rig()));
    EXPECT_EQ(sheets.size(), 7U);
    for (const char* file : {"stand_1.svg", "stand_4.svg", "stand_1.pdf", "stand_4.pdf"})
      EXPECT_GT(std::filesystem::file_size(folder.path() / name / file), 1000U) << file;
    for (const station::TargetSheet& sheet : sheets) {
      expect_to_scale(sheet, paper, folder.path() / name / (sheet.file + ".png"));
      std::ifstream pdf(folder.path() / name / (sheet.file + ".pdf"));
      std::string start(5, ' ');
      pdf.read(start.data(), 5);
      EXPECT_EQ(start, "%PDF-");
    }
  }
}

// The face of a plate on the ledge, leaning on the cheek, is where the calibration expects it.
TEST(Target, AStandHoldsAPlateAsTheCalibrationExpects) {
  const station::RigFile rig = station::read_rig(fixture_rig());
  for (int stand = 1; stand <= 4; ++stand) {
    const std::vector<Eigen::Vector2d> cheek = station::cheek_outline(rig, stand);
    const Eigen::Isometry3d plate =
        station::standing_pose(rig, rig::BenchObject::spectralon, stand, false);  // origin: middle of its face
    const Eigen::Vector2d up(plate.linear()(0, 1), plate.linear()(2, 1)),
        out(plate.linear()(0, 2), plate.linear()(2, 2));
    const Eigen::Vector2d foot =
        Eigen::Vector2d(plate.translation().x(), plate.translation().z() - rig.platform_height_mm) -
        rig.spectralon.plate_mm / 2 * up;
    const Eigen::Vector2d corner = cheek[5], top = cheek[6], lip = cheek[3];
    EXPECT_LT((corner + 5 * out - foot).norm(), 1e-9) << "the plate is 5 mm thick and stands in the corner";
    EXPECT_LT(std::abs((top - corner).dot(out)), 1e-9) << "its back lies on the cheek";
    EXPECT_LT((lip - foot).dot(up), 2.5) << "the tags are free";
    EXPECT_EQ(cheek.front().y(), 0);
    EXPECT_EQ(cheek.back().y(), 0);
    const double middle = plate.translation().x();
    EXPECT_GT(cheek.front().x(), middle + 10) << "it does not fall over";
    EXPECT_LT(cheek.back().x(), middle - 30);
  }
}

TEST(Target, TheGeometryFileIsTheBoardFileOfTheRigsBoard) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_threadstation({"target", "--out", folder.path(), "--rig", fixture_rig()}).status, 0);
  const station::BoardFile board = station::read_board(folder / "board.json");
  const auto& tags = std::get<calibration::TagLayout>(board.pattern).tags;
  const auto expected = station::read_rig(fixture_rig()).board.tags;
  ASSERT_EQ(tags.size(), expected.size());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    EXPECT_EQ(tags[i].id, expected[i].id);
    EXPECT_TRUE(tags[i].object_from_tag.isApprox(expected[i].object_from_tag));
  }
}

// Sizes of another bench would be believed.
TEST(Target, WithoutARigOneIsAskedForAndNothingIsWritten) {
  const TemporaryFolder folder;
  const ProgramResult result = run_threadstation({"target", "--out", folder / "targets"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.error_lines(), 1) << result.error;
  EXPECT_NE(result.error.find("--rig"), std::string::npos) << result.error;
  EXPECT_NE(result.error.find("/rigs"), std::string::npos) << result.error;  // where some are to begin with
  EXPECT_FALSE(std::filesystem::exists(folder / "targets"));
}

// A rig whose prints came out two percent large is drawn as it was, not two percent larger once more.
TEST(Target, AMeasuredControlBarDoesNotChangeWhatIsDrawn) {
  json rig = station::read_json_file(fixture_rig());
  rig["control_bar_mm"] = 102;
  const auto measured = station::target_sheets(station::parse_rig(rig, "r"));
  const auto drawn = station::target_sheets(station::read_rig(fixture_rig()));
  for (std::size_t s = 0; s < drawn.size(); ++s)
    for (std::size_t t = 0; t < drawn[s].tags.size(); ++t) {
      EXPECT_NEAR(measured[s].tags[t].size_mm, drawn[s].tags[t].size_mm, 1e-9);
      EXPECT_TRUE(measured[s].tags[t].object_from_tag.isApprox(drawn[s].tags[t].object_from_tag));
    }
  EXPECT_NEAR(station::parse_rig(rig, "r").board.tags[0].size_mm, 20.4, 1e-9);
}

TEST(Target, ATargetThatDoesNotFitOnThePaperIsRefusedInOneLineAndNothingIsWritten) {
  const TemporaryFolder folder;
  json rig = station::read_json_file(fixture_rig());
  rig["board"]["tag_mm"] = 50;
  rig["board"]["pitch_mm"] = 75;
  station::write_json_file(folder / "rig.json", rig);
  const ProgramResult result = run_threadstation({"target", "--out", folder / "targets", "--rig", folder / "rig.json"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.error_lines(), 1) << result.error;
  EXPECT_NE(result.error.find("Board"), std::string::npos) << result.error;
  EXPECT_FALSE(std::filesystem::exists(folder / "targets"));
}

}  // namespace
}  // namespace station_test
