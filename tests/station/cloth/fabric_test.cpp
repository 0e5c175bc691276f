// Cloth on the black cylinder: photographed on the recorded session's bench, developed, predicted and compared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/picture/image_file.h"
#include "station/cloth/measure_fabric.h"
#include "station/cloth/predict_fabric.h"
#include "station/documents/fiber_file.h"
#include "station/documents/reader.h"
#include "station/documents/views_file.h"
#include "station/output/compare/compare_pictures.h"
#include "station/session/capture_session.h"
#include "station/session/develop/develop_session.h"
#include "station/session/record/verify.h"
#include "station/thread/invert/invert_session.h"
#include "tests/places.h"
#include "tests/station/session/recorded_bench.h"

namespace station {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::filesystem::path fabric_file() {
  return std::filesystem::path(DATA_DIR) / "fabrics" / "satin_blue_gold.json";
}

struct FabricSession : testing::Test {
  static void SetUpTestSuite() {
    folder = new TemporaryFolder;
    json rig = read_json_file(recorded_session() / "session.json").at("rig");
    rig["simulation"]["samples_per_pixel"] = 96;  // the mosaic has a quarter of them in red and in blue
    // The same bench without its wires.
    rig["camera"] = rig["turntable"] = "simulated";
    for (const char* wire : {"camera_connection", "turntable_setup"}) rig.erase(wire);
    write_json_file(*folder / "rig.json", rig);
    capture_session({.session = session(),
                     .new_session = NewSession{.rig = *folder / "rig.json",
                                               .calibration = recorded_session() / "calibration",
                                               .spool = fabric_file(),
                                               .accept_calibration = true},
                     .progress_style = ProgressStyle::quiet});
    develop_session(session(), ProgressStyle::quiet);
    predicted = predict_fabric(
        {.cloth = {.session = session()}, .samples_per_pixel = 64, .progress_style = ProgressStyle::quiet});
    for (const PredictedView& view : predicted)  // before others are written in their place
      first_pictures.push_back(renderer::read_exr(view.prediction));
  }
  static void TearDownTestSuite() { delete folder; }
  static std::filesystem::path session() { return *folder / "cloth"; }

  static inline TemporaryFolder* folder = nullptr;
  static inline std::vector<PredictedView> predicted;
  static inline std::vector<cv::Mat3f> first_pictures;
};

TEST_F(FabricSession, IsASessionOfTwoViewsLitFromRightAndLeftAndHasAllThatPredictsIt) {
  const VerifyReport report = verify_session(session());
  EXPECT_TRUE(report.sound());
  EXPECT_EQ(report.views, 2U);
  const auto pictures = pictures_of(session());
  EXPECT_EQ(pictures.at("fabric-right-1").lamp, rig::Lamp::front);
  EXPECT_EQ(pictures.at("fabric-left-1").lamp, rig::Lamp::front_left);
  const json spool = read_json_file(session() / "session.json").at("spool");
  EXPECT_TRUE(spool.at("weave").at("draft").is_object()) << "no other file is needed";
  EXPECT_TRUE(spool.at("weave").at("threads").at(1).is_object());
}

// Of 64 samples a pixel: what the photograph differs by beyond it is not the renderings' noise.
TEST_F(FabricSession, TwoPredictionsDifferByLittle) {
  DevelopedViews developed = read_views(session());
  read_view_pictures(session(), developed);
  const std::vector<PredictedView> again = predict_fabric({.cloth = {.session = session()},
                                                           .samples_per_pixel = 64,
                                                           .seed = 77,
                                                           .fit_scale = true,
                                                           .progress_style = ProgressStyle::quiet});
  for (std::size_t i = 0; i < again.size(); ++i) {
    const CompareOptions options{
        .fit_scale = true, .block_px = again[i].block_px, .linear_srgb_from_camera = developed.linear_srgb_from_camera};
    const Comparison noise = compare_pictures(first_pictures[i], renderer::read_exr(again[i].prediction),
                                              developed.views[i].view.mask, options);
    EXPECT_LT(noise.mean_delta_e, 1) << again[i].view;
    EXPECT_NEAR(noise.scale, 1, 0.02) << again[i].view;
    const auto [darkest, brightest] = std::ranges::minmax(again[i].comparison.brightness);
    EXPECT_GT(again[i].comparison.scale * brightest, 1) << "asked for: as bright as its photograph";
    EXPECT_LT(again[i].comparison.scale * darkest, 1);
  }
}

// Light, shape and highlight are the photograph's. The colour of blocks is 2.6 (right) and 3.1 (left) CIEDE2000 off, of
// which 0.6 is the renderings' noise; what the rest is has not been found (yarns are near one pixel wide on this
// sensor, the cylinder stands by hand, the lamp on the left by tape). Another cloth is several times as far off.
TEST_F(FabricSession, LooksAsItsThreadsAndDraftPredictAndNotAsAnotherCloth) {
  ASSERT_EQ(predicted.size(), 2U);
  json other = read_spool_document(fabric_file());
  std::swap(other["weave"]["threads"][0], other["weave"]["threads"][1]);
  write_json_file(*folder / "other.json", other);
  const std::vector<PredictedView> others =
      predict_fabric({.cloth = {.session = session(), .fabric = *folder / "other.json"},
                      .samples_per_pixel = 16,
                      .progress_style = ProgressStyle::quiet});
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const PredictedView& view = predicted[i];
    const std::array<double, 3> brightness = view.comparison.brightness;
    std::printf("%s: CIEDE2000 %.2f, brightness %.3f %.3f %.3f; of another cloth %.2f\n", view.view.c_str(),
                view.comparison.mean_delta_e, brightness[0], brightness[1], brightness[2],
                others[i].comparison.mean_delta_e);
    EXPECT_LT(view.comparison.mean_delta_e, others[i].comparison.mean_delta_e / 3) << view.view;
    EXPECT_GT(view.comparison.profile_correlation, 0.99) << view.view;
    EXPECT_EQ(view.comparison.scale, 1) << "brightness counts";
    for (const double channel : brightness)
      EXPECT_NEAR(channel, 1, 0.1) << view.view << ": the lamp on the left is placed by tape";
  }
  // The lamp's side is where the light is; the picture's left is the bench's -y.
  EXPECT_GT(predicted[0].comparison.photograph.peak_px, predicted[1].comparison.photograph.peak_px + 20);
}

// A cloth is the same whether its fabric names the threads or the caller does, and a baseline's is another.
TEST_F(FabricSession, IsPredictedFromTheModelsThatOneGives) {
  const json weave = read_spool_document(fabric_file()).at("weave");
  for (const std::size_t k : {0U, 1U})
    write_json_file(*folder / ("thread" + std::to_string(k) + ".json"), weave.at("threads").at(k));
  const auto given = [&](const std::string& warp, const std::string& weft, const std::string& model, int samples) {
    return predict_fabric(
        {.cloth = {.session = session(), .warp = *folder / warp, .weft = *folder / weft, .model = model},
         .samples_per_pixel = samples,
         .progress_style = ProgressStyle::quiet});
  };
  const auto first_of = [](const std::vector<PredictedView>& views) { return renderer::read_exr(views[0].prediction); };
  const cv::Mat3f own = first_of(predict_fabric(
      {.cloth = {.session = session()}, .samples_per_pixel = 4, .progress_style = ProgressStyle::quiet}));
  const cv::Mat3f same = first_of(given("thread0.json", "thread1.json", "thread", 4));
  EXPECT_GT(cv::norm(own), 0);
  EXPECT_EQ(cv::norm(own, same, cv::NORM_INF), 0);
  std::filesystem::create_directories(*folder / "fitted" / "result" / "fiber");
  write_json_file(*folder / "fitted" / "result" / "fiber" / "fiber.json", to_json(renderer::FiberParameters{}));
  const std::vector<PredictedView> fiber = given("fitted", "fitted", "fiber", 8);
  EXPECT_EQ(fiber[0].prediction.parent_path(), session() / "result/fabric/fiber");
  EXPECT_GT(fiber[0].comparison.mean_delta_e, 2 * predicted[0].comparison.mean_delta_e);
  EXPECT_THAT(message_of([&] { given("fitted", "fitted", "yarn", 8); }), HasSubstr("invert"));
  EXPECT_THAT(message_of([&] { predict_fabric({.cloth = {.session = session(), .model = "fiber"}}); }),
              HasSubstr("--warp"));
  EXPECT_THAT(message_of([&] { predict_fabric({.cloth = {.session = session(), .weft = "x"}}); }),
              HasSubstr("give both"));
}

// The bench stretches the cloth round the cylinder until a whole number of repeats closes it.
TEST_F(FabricSession, ItsSettIsSeenInThePhotographs) {
  const MeasuredSett sett = measure_sett({.session = session()}, ProgressStyle::quiet);
  std::printf("%s", describe(sett).c_str());
  ASSERT_TRUE(sett.periods.around_mm && sett.periods.along_mm);
  const double middle_mm = 41 + 0.5, repeats = std::round(2 * std::numbers::pi * middle_mm / sett.said_around_mm);
  EXPECT_NEAR(sett.periods.around_mm->value, 2 * std::numbers::pi * middle_mm / repeats,
              4 * sett.periods.around_mm->sigma);
  EXPECT_NEAR(sett.periods.along_mm->value, sett.said_along_mm, 4 * sett.periods.along_mm->sigma);
  EXPECT_LT(sett.periods.along_mm->sigma, 0.01 * sett.said_along_mm);
}

// Its fabric file says flatter yarns than were photographed.
TEST_F(FabricSession, TheHeightOfItsYarnsIsSeenInItsHighlight) {
  json flatter = read_spool_document(fabric_file());
  flatter["weave"]["draft"]["height_scale"] = 0.8;
  write_json_file(*folder / "flatter.json", flatter);
  const MeasuredFabric measured = measure_fabric({.cloth = {.session = session(), .fabric = *folder / "flatter.json"},
                                                  .sett = false,
                                                  .height = true,
                                                  .samples_per_pixel = 8,
                                                  .progress_style = ProgressStyle::quiet});
  std::printf("%s", describe(measured).c_str());
  ASSERT_TRUE(measured.height->height_scale);
  const MeasuredValue found = *measured.height->height_scale;
  EXPECT_NEAR(found.value, 1, 4 * found.sigma);
  EXPECT_LT(found.sigma, 0.05);
  EXPECT_EQ(measured.draft.height_scale, found.value);
  EXPECT_EQ(measured.height->said, 0.8);
}

TEST_F(FabricSession, WhatCannotBePredictedOrInvertedIsOneLine) {
  json bare = read_spool_document(fabric_file());
  bare.erase("weave");
  write_json_file(*folder / "bare.json", bare);
  EXPECT_THAT(message_of([&] { predict_fabric({.cloth = {.session = session(), .fabric = *folder / "bare.json"}}); }),
              HasSubstr("woven of"));
  EXPECT_THAT(message_of([&] { predict_fabric({.cloth = {.session = recorded_session()}}); }),
              HasSubstr("wrapped thread"));
  EXPECT_THAT(message_of([&] { invert_session({.session = session()}); }), HasSubstr("cloth on the cylinder"));
  json few = read_spool_document(fabric_file());
  few["weave"]["threads"].erase(1);
  EXPECT_THAT(message_of([&] { parse_spool(few, "few.json"); }), HasSubstr("yarn of thread 1"));
}

}  // namespace
}  // namespace station
