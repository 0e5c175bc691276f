// The fibers that a simulated spool is drawn of: as one bundle, as plies of several absorptions, of metal.
#include "station/bench/spool_fibers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "inversion/view/agreement.h"
#include "inversion/view/irregularity.h"
#include "renderer/scattering/thread.h"
#include "renderer/trace/path_tracer.h"
#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
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

// The standard deviation of the shades in which a thread is drawn.
double drawn_shade(const Spool& spool) {
  double weights = 0, mean = 0, squares = 0;
  for (const renderer::CurveSet& set : spool_fibers(spool)) {
    const double shade = std::log(std::get<renderer::FiberParameters>(set.scattering).sigma_a.y() /
                                  spool.simulation->scattering.sigma_a.y());
    const auto pieces = static_cast<double>(set.segments.size());
    weights += pieces, mean += pieces * shade, squares += pieces * shade * shade;
  }
  mean /= weights;
  EXPECT_NEAR(mean, 0, 0.1);
  return std::sqrt(squares / weights - mean * mean);
}

// Shades and thicknesses of the turns, and the same of a thread that is even.
TEST(SpoolFibersTest, AnUnevenThreadIsUnevenAlongItself) {
  json document = spool_document("silk_red");
  const std::vector<renderer::CurveSet> even = spool_fibers(spool_of(document));
  document["simulation"]["uneven"] = {{"shade", 0.3}, {"diameter", 0.05}, {"length_mm", 100}};
  const Spool spool = spool_of(document);
  const std::vector<renderer::CurveSet> sets = spool_fibers(spool);
  ASSERT_GT(sets.size(), 8U);
  double lowest = 1e9, highest = -1e9;
  std::map<float, double> thicknesses;
  for (const renderer::CurveSet& set : sets)
    for (const Eigen::Vector4f& point : set.control_points) {
      ++thicknesses[point.w()];
      lowest = std::min<double>(lowest, point.z()), highest = std::max<double>(highest, point.z());
    }
  EXPECT_NEAR(drawn_shade(spool), 0.3, 0.06);
  EXPECT_EQ(thicknesses.size(), static_cast<std::size_t>(spool.wrapping.turns));
  double thickness = 0, thickness2 = 0;
  for (const auto& [radius, count] : thicknesses)
    thickness += radius / spool.simulation->fiber_radius_mm,
        thickness2 += std::pow(radius / spool.simulation->fiber_radius_mm, 2);
  const double turns = spool.wrapping.turns;
  EXPECT_NEAR(std::sqrt(thickness2 / turns - thickness * thickness / (turns * turns)), 0.05, 0.015);
  // Turns touch: the sheet is as high as they are thick together.
  EXPECT_NEAR(highest - lowest, thickness * spool.wrapping.thread_diameter_mm, 0.02 * (highest - lowest));
  std::size_t fibers = 0, of_even = 0;
  for (const renderer::CurveSet& set : sets) fibers += set.segments.size();
  for (const renderer::CurveSet& set : even) of_even += set.segments.size();
  EXPECT_GE(fibers, of_even);
  EXPECT_THAT(message_of([&] { bundled_fibers(spool); }), HasSubstr("uneven"));
  json metal = spool_document("metal_gold");
  metal["simulation"]["uneven"] = document["simulation"]["uneven"];
  EXPECT_THAT(message_of([&] { spool_of(metal); }), HasSubstr("leave it out"));
}

inversion::View small_view(int i) {
  inversion::View view;
  view.camera = renderer::look_at(Vector3d(580, 60 * i - 150, 40 * i - 100), Vector3d::Zero(), Vector3d::UnitZ());
  view.camera.width = 260, view.camera.height = 110;
  view.camera.fx = view.camera.fy = 2400;
  view.camera.cx = 129.5, view.camera.cy = 54.5;
  view.light.position = Vector3d(480, 120, 90 - 30 * i);
  return view;
}

std::vector<inversion::View> photographed(const Spool& spool, std::uint64_t seed) {
  std::vector<inversion::View> views;
  for (int i = 0; i < 6; ++i) {
    inversion::View view = small_view(i);
    renderer::Scene scene;
    scene.curves = spool_fibers(spool);
    scene.lights.push_back(inversion::sphere_light(view.light));
    const renderer::PathTracer tracer(scene);
    view.mask = tracer.curve_coverage(view.camera, 4);
    view.image = tracer.render(
        view.camera, {.samples_per_pixel = 12, .seed = seed + static_cast<std::uint64_t>(i), .only = view.mask});
    views.push_back(view);
  }
  return views;
}

// The library's thread in the places of these views.
inversion::FittedTwins fitted_twins(const Spool& spool, const std::vector<inversion::View>& views) {
  constexpr int kSamples = 12;
  const renderer::ThreadParameters thread =
      read_thread(fs::path(DATA_DIR) / "library" / "threads" / "silk_red.json").parameters;
  inversion::FittedTwins twins;
  twins.shaded = [=](std::size_t i, const std::vector<double>& shades) {
    return inversion::fitted_view(spool.wrapping, views.at(i),
                                  inversion::shaded_threads(spool.wrapping, thread, shades), kSamples, 71 + i);
  };
  const std::vector<double> darker(static_cast<std::size_t>(spool.wrapping.turns), 0.2);
  for (std::size_t i = 0; i < views.size(); ++i) {
    twins.even.push_back(inversion::fitted_view(spool.wrapping, views[i], thread, kSamples, 51 + i));
    const cv::Scalar light = cv::mean(twins.even[i], views[i].mask),
                     less = cv::mean(twins.shaded(i, darker), views[i].mask);
    for (int c = 0; c < 3; ++c)
      twins.darkening[c] += std::log(light[c] / less[c]) / darker[0] / static_cast<double>(views.size());
  }
  return twins;
}

// Photographs of the fibers against a fitted thread that knows nothing of them: fibers lie at random in the even one
// too, which is all that makes it uneven.
TEST(SpoolFibersTest, ItsUnevennessIsSeenInItsPhotographs) {
  json document = spool_document("silk_red");
  document["turns"] = 70;
  const Spool even = spool_of(document);
  document["simulation"]["uneven"] = {{"shade", 0.35}, {"diameter", 0}, {"length_mm", 60}};
  const Spool uneven = spool_of(document);
  const std::vector<inversion::View> pictures = photographed(uneven, 11), other = photographed(even, 31);
  const inversion::Irregularity found =
      inversion::measure_irregularity(even.wrapping, pictures, fitted_twins(even, pictures));
  const inversion::Irregularity none = inversion::measure_irregularity(even.wrapping, other, fitted_twins(even, other));
  ASSERT_TRUE(found.shade && none.shade);
  const double fibers = none.shade->value, truth = drawn_shade(uneven);  // of where they lie; of the absorption
  const double own = std::sqrt(std::max(0.0, std::pow(found.shade->value, 2) - fibers * fibers));
  std::printf("shade %.3f: %.3f +- %.3f over %.0f mm; of an even one %.3f +- %.3f, so that %.3f is the thread's\n",
              truth, found.shade->value, found.shade->sigma, found.length_mm, fibers, none.shade->sigma, own);
  EXPECT_NEAR(own, truth, 0.1 * truth + 2 * found.shade->sigma);
  EXPECT_LT(found.shade->sigma, 0.15 * truth);
  EXPECT_LT(fibers, 0.5 * truth);
  EXPECT_NEAR(std::log(found.length_mm / 60), 0, 0.8);
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
