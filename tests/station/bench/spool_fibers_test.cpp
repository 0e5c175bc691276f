// The fibers that a simulated spool is drawn of: as one bundle, as plies of several absorptions, of metal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "renderer/scattering/thread.h"
#include "station/bench/bench_picture.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/support/message_of.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using nlohmann::json;
using testing::HasSubstr;

json spool_document(const std::string& name) {
  return read_json_file(fs::path(DATA_DIR) / "library" / "spools" / (name + ".json"));
}

Spool spool_of(const json& document) {
  return parse_spool(document, "spool.json");
}

// The middle of each segment of a set: of a uniform cubic B-spline, (1, 23, 23, 1) / 48 of its control points.
std::vector<Vector3d> middles(const renderer::CurveSet& set) {
  std::vector<Vector3d> found;
  for (const std::uint32_t first : set.segments) {
    Vector3d sum = Vector3d::Zero();
    for (std::uint32_t k = 0; k < 4; ++k)
      sum += (k == 0 || k == 3 ? 1.0 : 23.0) / 48 * set.control_points.at(first + k).head<3>().cast<double>();
    found.push_back(sum);
  }
  return found;
}

TEST(SpoolFibersTest, PliesTouchAndTurnAboutTheThreadEachInItsAbsorption) {
  const json document = spool_document("cotton_marl_red");
  const Spool spool = spool_of(document);
  const std::vector<renderer::CurveSet> sets = spool_fibers(spool);
  ASSERT_EQ(sets.size(), 2U);
  const double radius = spool.wrapping.thread_diameter_mm / 2, turn = spool.simulation->plies->turn_mm;
  const inversion::Segment3 line = inversion::thread_lines(spool.wrapping).front();
  for (std::size_t ply = 0; ply < 2; ++ply) {
    const json& sigma = document.at("simulation").at("plies").at(ply).at("sigma_a");
    const auto& fiber = std::get<renderer::FiberParameters>(sets[ply].scattering);
    EXPECT_EQ(fiber.sigma_a, Vector3d(sigma[0], sigma[1], sigma[2]));
  }
  // Of the first thread: the places of each ply's fibers in sections along it.
  std::vector<std::vector<Vector3d>> of_ply(2);
  for (std::size_t ply = 0; ply < 2; ++ply)
    for (const Vector3d& at : middles(sets[ply]))
      if (std::abs(at.z() - line.from.z()) < radius)
        of_ply[ply].push_back(at - Vector3d(line.from.x(), 0, line.from.z()));
  double last_angle = 0, turned = 0, begin = 0, end = 0;
  for (double y = -20; y < 20; y += 0.13) {
    std::array<Vector3d, 2> centre{Vector3d::Zero(), Vector3d::Zero()};
    std::array<int, 2> count{0, 0};
    for (std::size_t ply = 0; ply < 2; ++ply)
      for (const Vector3d& at : of_ply[ply])
        if (std::abs(at.y() - y) < turn / 30) {
          centre[ply] += at, ++count[ply];
          EXPECT_LT(std::hypot(at.x(), at.z()) + spool.simulation->fiber_radius_mm, radius + 0.003);
        }
    ASSERT_GE(count[0], 12);
    for (std::size_t ply = 0; ply < 2; ++ply) centre[ply] /= count[ply];
    // Fibers are placed at random about the middle of their ply, which is half a radius out.
    const Vector3d across = centre[0] - centre[1];
    EXPECT_NEAR(std::hypot(across.x(), across.z()), radius, 0.25 * radius);
    const double angle = std::atan2(across.z(), across.x());
    if (y > -20)
      turned += std::remainder(angle - last_angle, 2 * std::numbers::pi), end = y;
    else
      begin = y;
    last_angle = angle;
  }
  EXPECT_NEAR(std::abs(turned) / (2 * std::numbers::pi), (end - begin) / turn, 0.1);
}

TEST(SpoolFibersTest, MetalReflectsItsColourAndLetsNothingThrough) {
  const Spool spool = spool_of(spool_document("metal_gold"));
  const std::vector<renderer::CurveSet> sets = spool_fibers(spool);
  ASSERT_EQ(sets.size(), 1U);
  const auto& metal = std::get<renderer::ThreadParameters>(sets[0].scattering);
  const renderer::ThreadModel<double> model(metal);
  for (const double h : {-0.9, -0.2, 0.4, 0.95})
    for (const double sine : {-0.8, 0.0, 0.5}) {
      const auto lobes = model.lobes_at(h, {sine, std::sqrt(1 - sine * sine), 0});
      EXPECT_LT((lobes.attenuation.row(0).matrix().transpose() - *spool.simulation->reflectance).norm(), 0.003);
      EXPECT_LT(lobes.attenuation.bottomRows(3).sum(), 1e-4);
    }
}

TEST(SpoolFibersTest, AllSpoolsOfTheLibraryCanBeDrawn) {
  int spools = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(DATA_DIR) / "library" / "spools")) {
    const Spool spool = read_spool(entry.path());
    EXPECT_NO_THROW(spool_fibers(spool)) << entry.path();
    EXPECT_GT(spool.wrapping.turns * spool.wrapping.thread_diameter_mm, spool.wrapping.window_height_mm)
        << entry.path();
    ++spools;
  }
  EXPECT_EQ(spools, 28);
}

TEST(SpoolFibersTest, WhatIsNoThreadIsOneLine) {
  json one = spool_document("cotton_marl_red");
  one["simulation"]["plies"].erase(1);
  EXPECT_THAT(message_of([&] { spool_of(one); }), HasSubstr("2 to 6"));
  json both = spool_document("metal_gold");
  both["simulation"]["sigma_a"] = {1, 1, 1};
  EXPECT_THAT(message_of([&] { spool_of(both); }), HasSubstr("sigma_a"));
  EXPECT_THAT(message_of([&] { bundled_fibers(spool_of(spool_document("metal_gold"))); }), HasSubstr("of metal"));
}

}  // namespace
}  // namespace station
