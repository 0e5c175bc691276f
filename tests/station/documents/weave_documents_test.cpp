#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "renderer/weave/initial_patch.h"
#include "renderer/weave/relaxation.h"
#include "renderer/weave/unevenness.h"
#include "station/documents/draft_drawing.h"
#include "station/documents/draft_file.h"
#include "station/documents/patch_file.h"
#include "station/documents/reader.h"
#include "station/documents/wif_file.h"
#include "tests/places.h"
#include "tests/station/documents/refusal.h"

namespace station {
namespace {

using nlohmann::json;
using station_test::refusal;
namespace fs = std::filesystem;

const fs::path kDrafts = fs::path(DATA_DIR) / "drafts";

void expect_refused(const json& document, bool is_draft, const std::string& named) {
  const std::string line =
      refusal([&] { is_draft ? void(parse_draft(document, "file.json")) : void(parse_patch(document, "file.json")); });
  EXPECT_EQ(line.rfind("file.json: ", 0), 0u) << line;
  EXPECT_NE(line.find(named), std::string::npos) << "expected \"" << named << "\", found: " << line;
}

class WeaveDocuments : public testing::Test {
 protected:
  WeaveDocuments()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("weave_") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~WeaveDocuments() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(WeaveDocuments, ReadyDraftsAreTheWeavesTheyAreNamedAfterAndDoNotOverlap) {
  const std::vector<std::pair<std::string, renderer::Draft>> ready{
      {"plain", renderer::plain_draft()},         {"twill_2_2", renderer::twill_draft(2, 2)},
      {"twill_3_1", renderer::twill_draft(3, 1)}, {"satin_5", renderer::satin_draft(5, 2)},
      {"satin_8", renderer::satin_draft(8, 3)},   {"basket_2_2", renderer::basket_draft(2)}};
  for (const auto& [file, made] : ready) {
    const renderer::Draft draft = read_draft(kDrafts / (file + ".json"));
    EXPECT_EQ(draft.name, made.name);
    EXPECT_EQ(draft.warp_over, made.warp_over) << file;
    EXPECT_EQ(draft.warp.diameter_mm, 0.5);  // the ready spools' threads
    // 1.1 % of the radius: what splines miss of arcs and floats
    EXPECT_GT(renderer::initial_patch(draft).least_gap_mm, -0.011 * 0.25) << file;
  }
}

TEST_F(WeaveDocuments, ADraftThatIsWrittenAndReadIsTheSameDraft) {
  renderer::Draft draft = renderer::satin_draft(8, 3);
  draft.warp = {.diameter_mm = 0.1 + 0.2, .pitch_mm = 1.0 / 3, .threads = {0, 2, 1}};
  draft.weft.pitch_mm = 0.77;
  draft.height_scale = 0.9;
  draft.weft.tex = 20.5;
  draft.weft.bending_n_mm2 = 0.031;
  draft.weft.tension_n = 1.7;
  draft.warp.contraction = 0.1 / 3;
  draft.weft.contraction = 0.02;
  draft.weft.flatness = 1.25;
  draft.free_periods = true;
  draft.transverse_modulus_n_mm2 = 12.5;
  draft.unevenness = {.radius = 0.03, .pitch = 0.1, .shades = 5, .seed = 77};
  draft.slubs = {.radius = 0.04, .twist = 0.06, .length_mm = 4.5, .shade_mm = 7.5};
  draft.plies = {.count = 3, .turns_per_mm = -0.4, .radius_mm = 0.06};
  write_json_file(folder_ / "draft.json", to_json(draft));
  const renderer::Draft read = read_draft(folder_ / "draft.json");
  EXPECT_EQ(to_json(read), to_json(draft));
  EXPECT_EQ(read.warp_over, draft.warp_over);
  EXPECT_EQ(read.warp.threads, draft.warp.threads);
  EXPECT_EQ(read.warp.pitch_mm, draft.warp.pitch_mm);  // all digits
}

TEST_F(WeaveDocuments, APatchThatIsWrittenAndReadIsTheSamePatchToTheLastDigit) {
  renderer::Draft draft = read_draft(kDrafts / "satin_5.json");
  draft.warp.threads = {0, 3};
  draft.unevenness.shades = 2;
  draft.slubs = {.radius = 0.05, .length_mm = 2, .shade_mm = 3};
  renderer::YarnPatch patch = renderer::initial_patch(draft);
  make_uneven(patch, draft);
  write_json_file(folder_ / "patch.json", to_json(patch));
  const renderer::YarnPatch read = read_patch(folder_ / "patch.json");
  EXPECT_EQ(read.name, patch.name);
  EXPECT_EQ(read.period_x_mm, patch.period_x_mm);
  EXPECT_EQ(read.period_y_mm, patch.period_y_mm);
  EXPECT_EQ(read.height_scale, patch.height_scale);
  EXPECT_EQ(read.thickness_mm, patch.thickness_mm);
  EXPECT_EQ(read.crimp_warp, patch.crimp_warp);
  EXPECT_EQ(read.crimp_weft, patch.crimp_weft);
  EXPECT_EQ(read.cover, patch.cover);
  EXPECT_EQ(read.least_gap_mm, patch.least_gap_mm);
  ASSERT_EQ(read.yarns.size(), patch.yarns.size());
  for (std::size_t i = 0; i < patch.yarns.size(); ++i) {
    EXPECT_EQ(read.yarns[i].warp, patch.yarns[i].warp);
    EXPECT_EQ(read.yarns[i].thread, patch.yarns[i].thread);
    EXPECT_EQ(read.yarns[i].radius_mm, patch.yarns[i].radius_mm);
    EXPECT_EQ(read.yarns[i].control_points, patch.yarns[i].control_points);
    EXPECT_FALSE(read.yarns[i].thickness.empty());
    EXPECT_EQ(read.yarns[i].thickness, patch.yarns[i].thickness);
    EXPECT_FALSE(read.yarns[i].threads.empty());
    EXPECT_EQ(read.yarns[i].threads, patch.yarns[i].threads);
  }
}

TEST_F(WeaveDocuments, EachBadDraftFileIsRefusedInOneLineThatNamesTheKey) {
  const json good = read_json_file(kDrafts / "plain.json");
  const auto spoiled = [&](const char* pointer, const json& value) {
    json document = good;
    document[json::json_pointer(pointer)] = value;
    return document;
  };
  expect_refused(spoiled("/colour", 1), true, "unknown key \"colour\"");
  expect_refused(spoiled("/warp/sett", 1), true, "unknown key \"warp.sett\"");
  expect_refused(spoiled("/version", 2), true, "version 2");
  expect_refused(spoiled("/format", "threadstation/patch"), true, "threadstation/draft");
  expect_refused(spoiled("/structure", "X."), true, "\"structure\"");
  expect_refused(spoiled("/structure/1", 5), true, "pick 2 is not text");
  expect_refused(spoiled("/structure/1", "x."), true, "pick 2 has a mark other than");
  expect_refused(spoiled("/structure", json::array()), true, "empty");
  expect_refused(spoiled("/structure/1", ".X."), true, "ragged");
  expect_refused(spoiled("/structure/1", "X."), true, "never interlaces");
  expect_refused(spoiled("/warp/pitch_mm", -1), true, "warp pitch is -1 mm");
  expect_refused(spoiled("/weft/pitch_mm", 0.3), true, "weft pitch 0.3 mm is less than the yarn diameter");
  expect_refused(spoiled("/weft/diameter_mm", "thin"), true, "\"weft.diameter_mm\"");
  expect_refused(spoiled("/weft/threads", json::array({0.5})), true, "\"weft.threads\"");
  expect_refused(spoiled("/weft/threads", json::array({1e300})), true, "\"weft.threads\"");
  expect_refused(spoiled("/height_scale", 0), true, "height scale is 0");
  expect_refused(spoiled("/warp/tension_n", -1), true, "warp tension is -1");
  expect_refused(spoiled("/weft/bending_n_mm2", -1), true, "weft bending stiffness is -1");
  expect_refused(spoiled("/weft/contraction", 0.5), true, "weft contraction is 0.5");
  expect_refused(spoiled("/weft/flatness", 0.9), true, "weft flatness is 0.9");
  expect_refused(spoiled("/weft/tex", -2), true, "weft tex is -2");
  expect_refused(spoiled("/periods", "free"), true, "warp yarns have no contraction");
  expect_refused(spoiled("/periods", "loose"), true, "\"periods\"");
  expect_refused(spoiled("/transverse_modulus_n_mm2", -1), true, "transverse modulus is -1");
  expect_refused(spoiled("/unevenness", json{{"radius", 0.5}}), true, "unevenness of the radius is 0.5");
  expect_refused(spoiled("/unevenness", json{{"depth", 0.5}}), true, "unknown key \"unevenness.depth\"");
  expect_refused(spoiled("/unevenness", json{{"shades", 0}}), true, "\"unevenness.shades\"");
  expect_refused(spoiled("/unevenness", json{{"seed", -1}}), true, "\"unevenness.seed\"");
  expect_refused(spoiled("/slubs", json{{"radius", -0.1}}), true, "slubs' deviation of the radius is -0.1");
  expect_refused(spoiled("/slubs", json{{"length_mm", 0}}), true, "slubs' length is 0");
  expect_refused(spoiled("/slubs", json{{"shade_mm", 4}}), true, "threads have one shade");
  expect_refused(spoiled("/slubs", 3), true, "\"slubs\"");
  expect_refused(spoiled("/plies", json{{"count", 99}}), true, "\"plies.count\"");
  expect_refused(spoiled("/plies", json{{"count", 2}, {"turns_per_mm", 50}}), true, "turns of the plies are 50 per mm");
  expect_refused(spoiled("/plies", json::object()), true, "\"plies.count\": is missing");
  json without = good;
  without.erase("weft");
  expect_refused(without, true, "\"weft\": is missing");
}

TEST_F(WeaveDocuments, EachBadPatchFileIsRefusedInOneLineThatNamesTheKey) {
  const json good = to_json(renderer::initial_patch(renderer::plain_draft()));
  const auto spoiled = [&](const char* pointer, const json& value) {
    json document = good;
    document[json::json_pointer(pointer)] = value;
    return document;
  };
  expect_refused(spoiled("/tiles", 3), false, "unknown key \"tiles\"");
  expect_refused(spoiled("/yarns/2/color", 3), false, "unknown key \"yarns[2].color\"");
  expect_refused(spoiled("/yarns", json::array()), false, "\"yarns\": the list is empty");
  expect_refused(spoiled("/yarns/0/system", "knit"), false, "\"yarns[0].system\"");
  expect_refused(spoiled("/yarns/0/radius_mm", 0), false, "\"yarns[0].radius_mm\"");
  expect_refused(spoiled("/yarns/1/thread", -1), false, "\"yarns[1].thread\"");
  expect_refused(spoiled("/yarns/1/thickness", json{1, 1}), false, "\"yarns[1].thickness\"");
  expect_refused(spoiled("/yarns/1/thickness", std::vector<double>(16, 0)), false, "\"yarns[1].thickness\"");
  expect_refused(spoiled("/yarns/1/threads", std::vector<double>(16, 0.5)), false, "\"yarns[1].threads\"");
  expect_refused(spoiled("/yarns/1/control_points_mm", json::array()), false, "at least 4 points");
  expect_refused(spoiled("/yarns/1/control_points_mm/3", json::array({1, 2})), false, "point 4 is not [x, y, z]");
  expect_refused(spoiled("/yarns/1/control_points_mm/3/0", nullptr), false, "point 4 is not [x, y, z]");
  expect_refused(spoiled("/period_x_mm", 0), false, "\"period_x_mm\"");
  expect_refused(spoiled("/measured/cover", 1.5), false, "\"measured.cover\"");
}

TEST_F(WeaveDocuments, FilesThatAreCutShortAreRefusedWhereverTheyAreCut) {
  const std::string draft = to_json(renderer::plain_draft()).dump(2),
                    patch = to_json(renderer::initial_patch(renderer::plain_draft())).dump(2);
  for (const std::string& whole : {draft, patch}) {
    for (std::size_t part = 0; part < 10; ++part) {
      const fs::path file = folder_ / "cut.json";
      std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() * part / 10);
      const std::string line = refusal([&] { whole == draft ? void(read_draft(file)) : void(read_patch(file)); });
      EXPECT_NE(line.find("ends too early"), std::string::npos) << line;
    }
  }
}

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

TEST_F(WeaveDocuments, AWifIsTheSameClothAsItsJson) {
  const renderer::Draft wif = read_draft(kDrafts / "houndstooth.wif"), draft = read_draft(kDrafts / "houndstooth.json");
  EXPECT_EQ(wif.name, draft.name);
  EXPECT_EQ(wif.warp_over, draft.warp_over);  // 16 x 16 written out, 4 x 4 the repeat
  for (const auto& [a, b] : {std::pair(wif.warp, draft.warp), std::pair(wif.weft, draft.weft)}) {
    EXPECT_EQ(a.threads, b.threads);
    EXPECT_NEAR(a.pitch_mm, b.pitch_mm, 1e-12);
    EXPECT_NEAR(a.diameter_mm, b.diameter_mm, 1e-12);
  }
}

TEST_F(WeaveDocuments, AWifsLiftPlanSinkingShedAndUnitsAreUnderstood) {
  const std::string good = text_of(kDrafts / "houndstooth.wif");
  const renderer::Draft draft = parse_wif(good, "file.wif");
  std::string plan = "[LIFTPLAN]\n";
  for (int pick = 0; pick < 16; ++pick)
    plan +=
        std::to_string(pick + 1) + "=" + std::to_string(pick % 4 + 1) + "," + std::to_string((pick + 1) % 4 + 1) + "\n";
  EXPECT_EQ(parse_wif(good + plan, "file.wif").warp_over, draft.warp_over);
  renderer::Draft sinking = parse_wif(replaced(good, "Rising Shed=true", "rising shed = FALSE ; sinks"), "file.wif");
  for (std::vector<bool>& pick : sinking.warp_over) pick.flip();
  EXPECT_EQ(sinking.warp_over, draft.warp_over);
  EXPECT_NEAR(parse_wif(replaced(good, "Units=centimeters\nSpacing=0.065\nThickness=0.05",
                                 "Units=Inches\nSpacing=0.03\nThickness=0.02"),
                        "file.wif")
                  .warp.pitch_mm,
              0.762, 1e-12);
  EXPECT_NEAR(parse_wif(replaced(good, "Units=centimeters\nSpacing=0.065\nThickness=0.05",
                                 "Units=Decipoints\nSpacing=20\nThickness=15"),
                        "file.wif")
                  .warp.pitch_mm,
              20 * 25.4 / 720, 1e-12);
}

TEST_F(WeaveDocuments, EachBadWifIsRefusedInOneLineThatNamesTheFault) {
  const std::string good = text_of(kDrafts / "houndstooth.wif");
  const struct {
    std::string text, named;
  } cases[]{{"", "is empty"},
            {"hello\n", "no [WIF] section"},
            {good + std::string(1, '\0') + "\n", "bytes of zero"},
            {replaced(good, "Units=centimeters", "Units=ells"), "[WARP] Units is \"ells\""},
            {replaced(good, "Thickness=0.05", ""), "[WARP] Thickness is missing"},
            {replaced(good, "Spacing=0.065", "Spacing=wide"), "[WARP] Spacing is \"wide\", expected a number"},
            {replaced(good, "Spacing=0.065", "Spacing=-0.065"), "warp pitch is -0.65 mm"},
            {replaced(good, "Thickness=0.05", "Thickness=0"), "warp diameter is 0 mm"},
            {replaced(good, "Spacing=0.065", "Spacing=0.04"), "neighbouring yarns overlap"},
            {replaced(good, "Threads=16", "Threads=17"), "no shaft for end 17"},
            {replaced(good, "Threads=16", "Threads=99999999"), "whole number from 1 to 4096"},
            {replaced(good, "Shafts=4", "Shafts=3"), "has \"4\", expected whole numbers from 0 to 3"},
            {replaced(good, "Shafts=4", "Shafts=nan"), "[WEAVING] Shafts"},
            {replaced(good, "4=4,1", "4=4,"), "[TIEUP] 4 ends before its number"},
            {replaced(good, "4=4,1\n", ""), "uses treadle 4"},
            {replaced(good, "4=4,1", "four=4,1"), "has \"four\""},
            {replaced(good, "1=1,2\n2=2,3\n3=3,4\n4=4,1", "1=0\n2=0\n3=0\n4=0"), "never interlaces"},
            {replaced(good, "Rising Shed=true", "Rising Shed=perhaps"), "expected true or false"}};
  for (const auto& [text, named] : cases) {
    const std::string line = refusal([&] { parse_wif(text, "file.wif"); });
    EXPECT_EQ(line.rfind("file.wif: ", 0), 0u) << line;
    EXPECT_NE(line.find(named), std::string::npos) << "expected \"" << named << "\", found: " << line;
  }
}

// A cut at the end of a line of the last section leaves a valid file (yarns without a colour have the system's); every
// other cut is noticed.
TEST_F(WeaveDocuments, AWifThatIsCutShortIsRefusedWhereverItIsCut) {
  const std::string good = text_of(kDrafts / "houndstooth.wif");
  const std::size_t last_section = good.find("[WEFT COLORS]");
  for (std::size_t size = 0; size < good.size(); ++size) {
    const std::string cut = good.substr(0, size);
    if (size > last_section && cut.back() == '\n') continue;
    EXPECT_FALSE(refusal([&] { parse_wif(cut, "file.wif"); }).empty()) << size;
  }
}

TEST_F(WeaveDocuments, EveryDraftInFixturesIsReadAndHasADrawing) {
  int count = 0;
  for (const fs::directory_entry& file : fs::directory_iterator(kDrafts)) {
    if (file.path().extension() != ".json" && file.path().extension() != ".wif") continue;
    const renderer::Draft draft = read_draft(file.path());
    const cv::Mat3b picture = draw_draft(draft, {}, 4);
    EXPECT_EQ(picture.cols, 4 * (ends_in_patch(draft) + 2)) << file.path();
    EXPECT_EQ(picture.rows, 4 * (picks_in_patch(draft) + 2)) << file.path();
    const std::string svg = draw_draft_svg(draft);
    EXPECT_EQ(svg.rfind("<svg", 0), 0u);
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
    ++count;
  }
  EXPECT_EQ(count, 13);
}

TEST_F(WeaveDocuments, EveryDraftInFixturesComesToRestAsDrafted) {
  for (const fs::directory_entry& file : fs::directory_iterator(kDrafts)) {
    if (file.path().extension() != ".json") continue;
    const renderer::RelaxationReport report = renderer::relax(read_draft(file.path())).report;
    std::printf("%-20s gradient %.1e, overlap %.2f %%, gap at crossings %.2f %%\n",
                file.path().filename().string().c_str(), report.gradient, 100 * report.overlap, 100 * report.crown_gap);
    EXPECT_TRUE(report.converged) << file.path();
    EXPECT_LT(report.gradient, renderer::kAtRest) << file.path();
    EXPECT_TRUE(report.as_drafted) << file.path();
    EXPECT_FALSE(report.jammed) << file.path();
    EXPECT_LE(report.overlap, renderer::kMostOverlap) << file.path();
  }
}

TEST_F(WeaveDocuments, TheExampleOfEveryOptionSaysWhatItsReadmeSays) {
  const renderer::Draft draft = read_draft(kDrafts / "slubbed_linen.json");
  EXPECT_EQ(draft.transverse_modulus_n_mm2, 8);
  EXPECT_EQ(draft.height_scale, 1);
  EXPECT_EQ(draft.unevenness.radius, 0.04);
  EXPECT_EQ(draft.unevenness.pitch, 0.1);
  EXPECT_EQ(draft.unevenness.shades, 2);
  EXPECT_EQ(draft.unevenness.seed, 1u);
  EXPECT_EQ(draft.slubs.radius, 0.08);
  EXPECT_EQ(draft.slubs.twist, 0.1);
  EXPECT_EQ(draft.slubs.length_mm, 2);
  EXPECT_EQ(draft.slubs.shade_mm, 6);
  EXPECT_EQ(draft.plies.count, 2);
  EXPECT_EQ(draft.plies.turns_per_mm, 0.4);
  EXPECT_EQ(draft.plies.radius_mm, 0);
}

TEST_F(WeaveDocuments, TheDrawingShowsTheYarnOnTopAndTheFirstPickAtTheBottom) {
  renderer::Draft draft = renderer::twill_draft(3, 1);
  const cv::Mat3b picture = draw_draft(draft, {}, 2);
  const cv::Vec3b warp = picture(0, 4), weft = picture(4, 0);  // the colour orders along the edges
  EXPECT_NE(warp, weft);
  const ThreadColours own{{10, 20, 30}, {200, 100, 50}};
  const cv::Mat3b in_their_colours = draw_draft(draft, own, 2);
  EXPECT_EQ(in_their_colours(0, 4), own[0]);
  EXPECT_EQ(in_their_colours(4, 0), own[1]);
  EXPECT_NE(draw_draft_svg(draft, own).find("#0a141e"), std::string::npos);
  for (int pick = 0; pick < 4; ++pick)
    for (int end = 0; end < 4; ++end)
      EXPECT_EQ(picture(2 * (5 - pick), 2 * (end + 2)),
                draft.warp_over[static_cast<std::size_t>(pick)][static_cast<std::size_t>(end)] ? warp : weft);
}

}  // namespace
}  // namespace station
