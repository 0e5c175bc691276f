// Views that a fit leaves out: which, and what the result, the report and the person are told of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/documents/degree.h"
#include "station/documents/reader.h"
#include "station/session/develop/develop_session.h"
#include "station/session/results.h"
#include "station/thread/invert/held_out_views.h"
#include "station/thread/invert/invert_session.h"
#include "station/thread/report/session_report.h"
#include "tests/station/session/recorded_bench.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::vector<DevelopedView> series(const std::string& name, rig::Mounting mounting, bool transmission, int count) {
  std::vector<DevelopedView> views;
  for (int i = 0; i < count; ++i) {
    DevelopedView& view = views.emplace_back();
    view.view.id = name + std::to_string(i);
    view.view.transmission = transmission;
    view.mounting = mounting;
    view.platform_angle_rad = (20 * i - 50) * kDegree;
  }
  return views;
}

// The default plan's, in the order of a capture.
std::vector<DevelopedView> seventeen_views() {
  std::vector<DevelopedView> views = series("h", rig::Mounting::horizontal, false, 6);
  for (DevelopedView& view : series("t", rig::Mounting::horizontal, true, 5)) views.push_back(view);
  for (DevelopedView& view : series("v", rig::Mounting::vertical, false, 6)) views.push_back(view);
  return views;
}

std::vector<std::string> left_out(const std::vector<DevelopedView>& views, int count) {
  const std::vector<bool> out = held_out_views(views, count);
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (out[i]) ids.push_back(views[i].view.id);
  return ids;
}

TEST(HeldOutViews, AreSpreadOverLightsMountingsAndAngles) {
  const std::vector<DevelopedView> views = seventeen_views();
  EXPECT_THAT(left_out(views, 0), IsEmpty());
  EXPECT_THAT(left_out(views, 1), ElementsAre("h3"));
  EXPECT_THAT(left_out(views, 2), ElementsAre("h3", "t2"));
  EXPECT_THAT(left_out(views, 3), ElementsAre("h3", "t2", "v3"));
  EXPECT_THAT(left_out(views, 6), ElementsAre("h1", "h4", "t1", "t3", "v1", "v4"));
}

TEST(HeldOutViews, HaveFittedOnesOnBothSidesInWhateverOrderTheyWereTaken) {
  std::vector<DevelopedView> views = series("v", rig::Mounting::vertical, false, 7);
  std::swap(views[0], views[3]);
  std::swap(views[6], views[2]);
  for (int count = 1; count <= 3; ++count) {
    const std::vector<bool> out = held_out_views(views, count);
    EXPECT_EQ(std::ranges::count(out, true), count);
    for (std::size_t i = 0; i < views.size(); ++i)
      if (out[i])
        for (const int side : {-1, 1}) {
          const double neighbour_rad = views[i].platform_angle_rad + side * 20 * kDegree;
          EXPECT_TRUE(std::ranges::any_of(views,
                                          [&](const DevelopedView& view) {
                                            return std::abs(view.platform_angle_rad - neighbour_rad) < 1e-9 &&
                                                   !out[static_cast<std::size_t>(&view - views.data())];
                                          }))
              << views[i].view.id << " of " << count;
        }
  }
}

TEST(HeldOutViews, CannotBeMoreThanLeaveFittedOnesAboutThem) {
  EXPECT_THAT(message_of([] { held_out_views(seventeen_views(), 7); }),
              testing::AllOf(HasSubstr("--hold-out 7"), HasSubstr("17 views"), HasSubstr("at most 6")));
  EXPECT_THAT(message_of([] { held_out_views({}, 1); }), HasSubstr("at most 0"));
}

struct HeldOutFit : testing::Test {
  static InvertResult inverted(const fs::path& session, inversion::ModelKind model, int held_out) {
    InvertRequest request{.session = session, .held_out = held_out, .samples_per_pixel = 2};
    request.progress_style = ProgressStyle::quiet;
    request.fit.model = model;
    request.fit.paths_per_block = {16};
    return invert_session(request);
  }
};

TEST_F(HeldOutFit, IsToldApartInTheFileTheTextAndTheReportBesideTheBaselines) {
  const TemporaryFolder folder;
  const fs::path session = folder / "session";
  fs::copy(recorded_session(), session, fs::copy_options::recursive);
  develop_session(session, ProgressStyle::quiet);
  const InvertResult thread = inverted(session, inversion::ModelKind::thread, 2);
  std::vector<std::string> held;
  double square = 0, mean = 0;
  for (const FittedView& view : thread.views)
    if (view.held_out) {
      held.push_back(view.id);
      square += view.agreement.mean_square / 2, mean += view.agreement.mean_reference / 2;
    }
  EXPECT_THAT(held, ElementsAre("reflection-horizontal-4", "transmission-3"));
  EXPECT_NEAR(thread.fit.at("relative_rmse_held_out").get<double>(), std::sqrt(square) / mean, 1e-12);
  for (const json& view : thread.fit.at("views")) EXPECT_NE(view.contains("held_out"), view.contains("weight")) << view;
  const std::string said = describe(thread);
  EXPECT_THAT(said, HasSubstr("transmission-3 (held out): relative RMSE"));
  EXPECT_THAT(said, HasSubstr("views that the fit has not seen"));
  EXPECT_TRUE(fs::exists(fitted_file_of(session, "transmission-3")));

  write_session_report(session);
  std::string page = text_of(session / "report.html");
  EXPECT_THAT(page, HasSubstr("held out: relative RMSE"));
  EXPECT_THAT(page, HasSubstr("<th>held-out views</th>"));
  EXPECT_THAT(page, Not(HasSubstr("<th>fiber</th>")));
  inverted(session, inversion::ModelKind::fiber, 2);
  write_session_report(session);
  page = text_of(session / "report.html");
  EXPECT_THAT(page, HasSubstr("<th>fiber</th>"));
  EXPECT_THAT(page, HasSubstr("transmission-3 fiber residual"));
  EXPECT_THAT(page, Not(HasSubstr("other views held out")));
  inverted(session, inversion::ModelKind::fiber, 0);
  write_session_report(session);
  EXPECT_THAT(text_of(session / "report.html"), HasSubstr("The fiber was fitted with other views held out"));
}

TEST_F(HeldOutFit, ByThePapersRecipeStandsBesideOurs) {
  const TemporaryFolder folder;
  const fs::path session = folder / "session";
  fs::copy(recorded_session(), session, fs::copy_options::recursive);
  develop_session(session, ProgressStyle::quiet);
  inverted(session, inversion::ModelKind::thread, 2);
  InvertRequest request{.session = session, .held_out = 2, .samples_per_pixel = 2};
  request.progress_style = ProgressStyle::quiet;
  request.fit.model = inversion::ModelKind::paper;
  request.fit.adam_steps = 2, request.fit.adam_paths = 16, request.fit.paths_per_pixel = 4;
  const InvertResult paper = invert_session(request);
  EXPECT_EQ(paper.file, session / "result/paper/paper.json");
  EXPECT_EQ(read_json_file(paper.file).at("parameters").at("exit"), "entry_point");
  EXPECT_EQ(paper.fit.at("solver"), "adam");
  EXPECT_EQ(paper.fit.at("robust"), false);
  EXPECT_EQ(paper.fit.at("block_px"), read_json_file(session / "result/thread.json").at("fit").at("block_px"));
  EXPECT_THAT(describe(paper), testing::AllOf(HasSubstr("sigma_a 0."), HasSubstr("paper.json")));
  write_session_report(session);
  const std::string page = text_of(session / "report.html");
  EXPECT_THAT(page, HasSubstr("<th>paper</th>"));
  EXPECT_THAT(page, HasSubstr("transmission-3 paper residual"));
}

// The fit without two views is the fit to a session that never had them.
TEST_F(HeldOutFit, DoesNotSeeThem) {
  const TemporaryFolder folder;
  const fs::path session = folder / "session", without = folder / "without";
  fs::copy(recorded_session(), session, fs::copy_options::recursive);
  develop_session(session, ProgressStyle::quiet);
  fs::copy(session, without, fs::copy_options::recursive);
  json views = read_json_file(without / "linear" / "views.json");
  json kept = json::array();
  for (const json& view : views.at("views"))
    if (view.at("id") != "reflection-horizontal-4" && view.at("id") != "transmission-3") kept.push_back(view);
  views["views"] = kept;
  write_json_file(without / "linear" / "views.json", views);
  const json held = inverted(session, inversion::ModelKind::thread, 2).fit.at("certainty");
  EXPECT_EQ(held, inverted(without, inversion::ModelKind::thread, 0).fit.at("certainty"));
  EXPECT_NE(held, inverted(session, inversion::ModelKind::thread, 0).fit.at("certainty"));
}

}  // namespace
}  // namespace station
