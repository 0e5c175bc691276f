// Views that another lab measured become a session: pictures rendered of a known thread from directions drawn at
// random, written as a lab would have them.
#include "station/session/import_measured.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "renderer/picture/image_file.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/session/capture_session.h"
#include "station/session/develop/develop_session.h"
#include "station/session/record/verify.h"
#include "tests/places.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr unsigned kSeed = 20261201;
constexpr int kWidth = 90, kHeight = 60;

// A camera written out: its axes from angles, without the program's own look_at.
struct Row {
  double view_azimuth, view_elevation, roll, light_azimuth, light_elevation;  // degrees
  Vector3d eye(double distance) const { return distance * towards(view_azimuth, view_elevation); }
  Vector3d lamp(double distance) const { return distance * towards(light_azimuth, light_elevation); }
  static Vector3d towards(double azimuth, double elevation) {
    const double a = azimuth * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
    return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  }
};

struct Measured : testing::Test {
  static constexpr double kCamera_mm = 600, kLight_mm = 500, kFocal_px = 700;

  Measured() {
    json spool = read_json_file(fs::path(DATA_DIR) / "spools" / "silk_red.json");
    write_json_file(folder / "spool.json", spool);
    std::printf("seed %u\n", kSeed);
    std::mt19937 random(kSeed);
    const auto between = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int i = 0; i < 6; ++i)
      rows.push_back({between(-50, 50), between(-40, 40), i % 3 == 2 ? 90.0 : between(-20, 20),
                      (i % 2 ? 180 : 0) + (i % 2 ? -1 : 1) * between(-50, 50), between(-40, 40)});
    for (Row& row : rows)
      if (row.light_azimuth > 180) row.light_azimuth -= 360;
    for (std::size_t i = 0; i < rows.size(); ++i)
      cv::imwrite(folder / picture(i), random_picture(i), {cv::IMWRITE_TIFF_COMPRESSION, 1});
    list = {{"format", "threadstation/measurement"},
            {"version", 1},
            {"spool", "spool.json"},
            {"views", "views.csv"},
            {"operator", "Grace"},
            {"camera", {{"distance_mm", kCamera_mm}, {"focal_length_px", kFocal_px}}},
            {"light", {{"distance_mm", kLight_mm}, {"radius_mm", 4}, {"diffuser_radiance", {0.5, 0.4, 0.3}}}}};
  }

  static std::string picture(std::size_t i) { return "view-" + std::to_string(i) + (i == 1 ? ".exr" : ".tif"); }
  // As OpenCV stores colours, blue first.
  static cv::Mat random_picture(std::size_t i) {
    cv::Mat3f picture(kHeight, kWidth);
    cv::theRNG().state = 77 + i;
    cv::randu(picture, 0.01, 0.9);
    if (i != 0) return picture;
    cv::Mat_<cv::Vec3w> words;
    picture.convertTo(words, CV_16UC3, 65535);
    return words;
  }

  void write(const std::string& extra_columns = "", const std::string& extra_cells = "") {
    if (!fs::exists(folder / "view-1.exr")) {
      cv::Mat3f rgb;
      cv::cvtColor(random_picture(1), rgb, cv::COLOR_BGR2RGB);
      renderer::write_exr(folder / "view-1.exr", rgb);
    }
    std::ofstream table(folder / "views.csv");
    table << "image,view_azimuth_deg,view_elevation_deg,roll_deg,light_azimuth_deg,light_elevation_deg" << extra_columns
          << "\n";
    table.precision(17);
    for (std::size_t i = 0; i < rows.size(); ++i)
      table << picture(i) << "," << rows[i].view_azimuth << "," << rows[i].view_elevation << "," << rows[i].roll << ","
            << rows[i].light_azimuth << "," << rows[i].light_elevation << extra_cells << "\n";
    table.close();
    write_json_file(folder / "measured.json", list);
  }
  void import(const std::string& name) {
    import_measured(folder / "measured.json", folder / name, ProgressStyle::quiet);
  }
  std::string refusal() {
    return message_of([&] { import("refused"); });
  }

  TemporaryFolder folder;
  std::vector<Row> rows;
  json list;
};

TEST_F(Measured, CamerasAndLampsStandWhereTheTableSaysAndPicturesAreAsTheyCame) {
  write(",brightness", ",1.25");
  import("session");
  EXPECT_TRUE(verify_session(folder / "session").sound());
  EXPECT_TRUE(verify_session(folder / "session").complete);
  EXPECT_EQ(read_session_file(folder / "session").person, "Grace");
  DevelopedViews views = read_views(folder / "session");
  read_view_pictures(folder / "session", views);
  ASSERT_EQ(views.views.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const inversion::View& view = views.views[i].view;
    const Row& row = rows[i];
    EXPECT_LT((view.camera.world_from_camera.translation() - row.eye(kCamera_mm)).norm(), 1e-6);
    EXPECT_LT((view.light.position - row.lamp(kLight_mm)).norm(), 1e-6);
    EXPECT_EQ(view.transmission, row.lamp(1).x() < 0);
    // The middle of the sheet is in the middle of the picture. The threads' axis is where the unrolled camera has it,
    // horizontal, turned the other way than the camera.
    const Eigen::Vector2d middle = renderer::project(view.camera, Vector3d::Zero());
    EXPECT_LT((middle - Eigen::Vector2d((kWidth - 1) / 2.0, (kHeight - 1) / 2.0)).norm(), 1e-6);
    const Vector3d ahead = -row.eye(1), right_of_upright = ahead.cross(Vector3d::UnitZ()).normalized(),
                   down_of_upright = ahead.cross(right_of_upright).normalized();
    const double roll = row.roll * std::numbers::pi / 180;
    const Vector3d right = Eigen::AngleAxisd(roll, row.eye(1)) * right_of_upright,
                   down = Eigen::AngleAxisd(roll, row.eye(1)) * down_of_upright;
    for (const Vector3d& point : {Vector3d(3, 0, 0), Vector3d(0, 7, 0), Vector3d(0, 0, 5)}) {
      const double depth = kCamera_mm + point.dot(ahead);
      const Eigen::Vector2d expected = middle + kFocal_px / depth * Eigen::Vector2d(point.dot(right), point.dot(down));
      EXPECT_LT((renderer::project(view.camera, point) - expected).norm(), 1e-6) << "view " << i;
    }
    // A white diffuser that faces the light has what was said.
    EXPECT_LT((inversion::diffuser_radiance(view.light) - Vector3d(0.5, 0.4, 0.3)).norm(), 1e-9);
    cv::Mat measured, rgb;
    random_picture(i).convertTo(measured, CV_32F, i == 0 ? 1.0 / 65535 : 1.0);
    cv::cvtColor(measured, rgb, cv::COLOR_BGR2RGB);
    EXPECT_LT(cv::norm(view.image * 1.25, rgb, cv::NORM_INF), 1e-6) << "view " << i;
    EXPECT_GT(cv::countNonZero(view.mask), 100) << "view " << i;
  }
}

TEST_F(Measured, MasksThatCameWithThePicturesArePartOfTheSession) {
  write(",mask", ",mask.png");
  cv::Mat1b mask(kHeight, kWidth, uchar{0});
  mask(cv::Rect(40, 20, 11, 9)) = 255;
  renderer::write_png(folder / "mask.png", mask);
  import("session");
  fs::remove(folder / "mask.png");
  EXPECT_EQ(develop_session(folder / "session", ProgressStyle::quiet).views[0].masked_pixels, 11 * 9);
  EXPECT_TRUE(verify_session(folder / "session").sound());
}

TEST_F(Measured, AnImportThatWasInterruptedGoesOn) {
  write();
  import("session");
  const std::string views = read_json_file(folder / "session/linear/views.json").dump();
  // As if the process had gone after the third picture.
  std::string journal = text_of_file(folder / "session/journal.jsonl"), kept;
  std::istringstream lines(journal);
  std::string line;
  for (int i = 0; i < 4 && std::getline(lines, line); ++i) kept += line + "\n";
  std::ofstream(folder / "session/journal.jsonl") << kept;
  fs::remove_all(folder / "session/linear");
  import("session");
  EXPECT_TRUE(verify_session(folder / "session").complete);
  EXPECT_EQ(read_json_file(folder / "session/linear/views.json").dump(), views);
  list["camera"]["distance_mm"] = 601;
  write();
  EXPECT_THAT(message_of([&] { import("session"); }), HasSubstr("another folder"));
}

TEST_F(Measured, WhatCannotBeMeantIsOneLine) {
  write();
  rows[2].view_azimuth = 120;
  write();
  EXPECT_THAT(refusal(), AllOf(HasSubstr("views.csv, line 4"), HasSubstr("from behind")));
  rows[2].view_azimuth = 10, rows[3].light_azimuth = 90;
  write();
  EXPECT_THAT(refusal(), AllOf(HasSubstr("line 5"), HasSubstr("plane of the sheet")));
  rows[3].light_azimuth = 0;
  write(",brightness", ",bright");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("brightness"), HasSubstr("'bright'")));
  write(",id", ",same");
  EXPECT_THAT(refusal(), HasSubstr("there already"));
  write();
  list["light"]["intensity_mm2"] = {1, 1, 1};
  write();
  EXPECT_THAT(refusal(), HasSubstr("either"));
  list["light"].erase("intensity_mm2");
  list["camera"]["focal_length_px"] = 1e7;
  rows.resize(1);
  list["camera"]["principal_point_px"] = {-5e6, -5e6};
  write();
  EXPECT_THAT(refusal(), HasSubstr("check its angles"));
  list["camera"] = {{"distance_mm", kCamera_mm}, {"focal_length_px", kFocal_px}};
  cv::imwrite(folder / "view-0.tif", cv::Mat3b(kHeight, kWidth, cv::Vec3b(9, 9, 9)));
  write();
  EXPECT_THAT(refusal(), HasSubstr("8 bits"));
  fs::rename(folder / "view-0.tif", folder / "view-0");
  std::string table = text_of_file(folder / "views.csv");
  table.replace(table.find("view-0.tif"), 10, "view-0");
  std::ofstream(folder / "views.csv") << table;
  EXPECT_THAT(refusal(), HasSubstr("rename it"));
  EXPECT_THAT(message_of([&] { capture_session({.session = folder / "refused"}); }), HasSubstr("measured elsewhere"));
}

}  // namespace
}  // namespace station
