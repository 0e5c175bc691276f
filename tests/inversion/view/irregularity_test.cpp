// Sheets of thread whose brightness and thickness are known at every place, drawn pixel by pixel without the renderer:
// unevenness, lengths, noise and cameras drawn at random.
#include "inversion/view/irregularity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>

#include "renderer/scattering/degree.h"

namespace inversion {
namespace {

using Eigen::Vector3d;

constexpr unsigned kIrregularitySeed = 20261204;
constexpr int kSheetViews = 8;
// Most of the light comes from a little below the top of a thread.
constexpr double kLitAt = 0.85;

// A wave along the thread with variance 1 and correlation exp(-(d / length)^2): cosines whose frequencies are normal.
class Wave {
 public:
  Wave(double length_mm, std::mt19937& random) {
    std::normal_distribution<double> frequency(0, std::numbers::sqrt2 / length_mm);
    std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
    for (Cosine& one : cosines_) one = {frequency(random), phase(random)};
  }
  double at(double along_mm) const {
    double sum = 0;
    for (const Cosine& one : cosines_) sum += std::cos(one.frequency * along_mm + one.phase);
    return sum * std::sqrt(2.0 / static_cast<double>(cosines_.size()));
  }

 private:
  struct Cosine {
    double frequency, phase;
  };
  std::array<Cosine, 80> cosines_;
};

struct Uneven {
  double shade, diameter, length_mm;
};

// By how much the logarithm of the light falls with that of all turns' absorption, and how much of it is due to the
// turn itself and to each neighbour.
constexpr double kDarkening = 0.5, kOwn = 0.8, kNeighbours = 0.1;

// What the waves are on this thread itself, which is not as long as their mean would need.
struct Truth {
  double brightness, shade, diameter;
};

struct Photographs {
  std::vector<View> views;
  FittedTwins twins;
  Truth truth;
};

double spread(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double value : values) sum += value, squares += value * value;
  const auto count = static_cast<double>(values.size());
  return std::sqrt(squares / count - sum * sum / (count * count));
}

// The logarithm of the light of a turn of these shades, those beyond the sheet being as its last.
double light_of(std::size_t turn, const std::function<double(std::size_t)>& shade, std::size_t turns) {
  return -kDarkening *
         (kOwn * shade(turn) + kNeighbours * (shade(turn == 0 ? 0 : turn - 1) + shade(std::min(turn + 1, turns - 1))));
}

// The turn and the place along it that each pixel of the sheet shows: calls use(row, column, turn, y, across), across
// from -0.5 to 0.5 of the turn.
template <class Use>
void each_place(const View& view, const WrappedSpool& spool, const std::vector<double>& edges, const Use& use) {
  const Vector3d eye = view.camera.world_from_camera.translation();
  for (int row = 0; row < view.camera.height; ++row)
    for (int column = 0; column < view.camera.width; ++column) {
      const Vector3d way =
          view.camera.world_from_camera.linear() *
          Vector3d((column - view.camera.cx) / view.camera.fx, (row - view.camera.cy) / view.camera.fy, 1);
      const Vector3d at = eye + (kLitAt * spool.thread_diameter_mm - eye.x()) / way.x() * way;
      const auto turn = static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), at.z()) - edges.begin());
      if (turn < 1 || turn >= edges.size() || std::abs(at.y()) >= spool.frame_width_mm / 2 - 1) continue;
      use(row, column, turn - 1, at, (at.z() - edges[turn - 1]) / (edges[turn] - edges[turn - 1]) - 0.5);
    }
}

View random_view(double pixels_per_mm, bool upright, std::mt19937& random) {
  std::uniform_real_distribution<double> anywhere(-1, 1);
  View view;
  const double azimuth = 45 * anywhere(random) * renderer::kDegree,
               elevation = 20 * anywhere(random) * renderer::kDegree;
  const Vector3d eye = 600 * Vector3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                      std::sin(elevation));
  view.camera = renderer::look_at(eye, Vector3d::Zero(), upright ? Vector3d::UnitZ() : Vector3d::UnitY());
  const int width = static_cast<int>(74 * pixels_per_mm), height = static_cast<int>(60 * pixels_per_mm);
  view.camera.width = upright ? width : height, view.camera.height = upright ? height : width;
  view.camera.fx = view.camera.fy = 600 * pixels_per_mm;
  view.camera.cx = (view.camera.width - 1) / 2.0, view.camera.cy = (view.camera.height - 1) / 2.0;
  return view;
}

// Edges of turns of these thicknesses that touch, about the middle of the sheet.
std::vector<double> edges_of(const std::vector<double>& thickness_mm) {
  std::vector<double> edges{0};
  for (const double one : thickness_mm) edges.push_back(edges.back() + one);
  for (double& edge : edges) edge -= edges.back() / 2;
  return edges;
}

Photographs photographs_of(const WrappedSpool& spool, const Uneven& uneven, double pixels_per_mm, double noise,
                           std::mt19937& random) {
  const Wave dark(uneven.length_mm, random), thick(uneven.length_mm, random);
  const double turn_mm = 2 * (spool.frame_width_mm + spool.frame_depth_mm), d = spool.thread_diameter_mm;
  const auto turns = static_cast<std::size_t>(spool.turns);
  const auto light_at = [&](std::size_t turn, double y) {
    return light_of(
        turn, [&](std::size_t one) { return uneven.shade * dark.at(static_cast<double>(one) * turn_mm + y); }, turns);
  };
  std::vector<double> thickness, shade, brightness;
  for (std::size_t turn = 0; turn < turns; ++turn) {
    thickness.push_back(d * (1 + uneven.diameter * thick.at(static_cast<double>(turn) * turn_mm)));
    shade.push_back(uneven.shade * dark.at(static_cast<double>(turn) * turn_mm));
    brightness.push_back(light_at(turn, 0));
  }
  Photographs made{.truth = {spread(brightness), spread(shade), spread(thickness) / d}};
  std::normal_distribution<double> normal;
  for (int i = 0; i < kSheetViews; ++i) {
    View view = random_view(pixels_per_mm, i % 2 == 0, random);
    view.image.create(view.camera.height, view.camera.width);
    view.image.setTo(0);
    view.mask = cv::Mat1b(view.image.size(), 0);
    each_place(view, spool, edges_of(thickness),
               [&](int row, int column, std::size_t turn, const Vector3d& at, double across) {
                 // Light that changes slowly and differs from what the model takes it for, and a crown on each turn.
                 const double wrong = 1 + 0.004 * at.y() - 0.0005 * at.z() * at.z();
                 const double crown = 0.4 + 0.6 * std::cos(std::numbers::pi * across);
                 const auto light = static_cast<float>((1 + 0.01 * at.y() + 0.02 * at.z()) * wrong * crown *
                                                       std::exp(light_at(turn, at.y())) * (1 + noise * normal(random)));
                 view.image(row, column) = {light, light, light};
                 view.mask(row, column) = 255;
               });
    made.views.push_back(view);
  }
  const auto twin = [=, views = made.views](std::size_t index, const std::vector<double>& shades) {
    const View& view = views.at(index);
    cv::Mat3f picture(view.image.size(), cv::Vec3f(0, 0, 0));
    std::mt19937 own(static_cast<unsigned>(index) + 1);
    std::normal_distribution<double> grain;
    each_place(view, spool, edges_of(std::vector(turns, d)),
               [&](int row, int column, std::size_t turn, const Vector3d& at, double) {
                 const auto light =
                     static_cast<float>((1 + 0.01 * at.y() + 0.02 * at.z()) * 0.78 * (1 + noise * grain(own)) *
                                        std::exp(light_of(
                                            turn, [&](std::size_t one) { return shades.at(one); }, turns)));
                 picture(row, column) = {light, light, light};
               });
    return picture;
  };
  made.twins.shaded = twin;
  for (std::size_t i = 0; i < made.views.size(); ++i) made.twins.even.push_back(twin(i, std::vector(turns, 0.0)));
  made.twins.darkening = Eigen::Array3d::Constant(kDarkening);
  return made;
}

TEST(IrregularityTest, ShadeThicknessAndLengthAreThoseOfTheThread) {
  std::printf("seed %u\n", kIrregularitySeed);
  std::mt19937 random(kIrregularitySeed);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  const WrappedSpool spool{.turns = 60, .thread_diameter_mm = 0.5};
  for (int trial = 0; trial < 4; ++trial) {
    const Uneven uneven{.shade = between(0.06, 0.4), .diameter = between(0.02, 0.06), .length_mm = between(30, 400)};
    // The last is seen in so few pixels that a cell is several turns.
    const double pixels_per_mm = trial == 3 ? 3 : 7;
    const auto [views, twins, truth] = photographs_of(spool, uneven, pixels_per_mm, between(0.05, 0.2), random);
    const Irregularity found = measure_irregularity(spool, views, twins);
    ASSERT_TRUE(found.brightness && found.shade);
    std::printf("brightness %.4f: %.4f +- %.4f; shade %.4f (%.4f on this thread): %.4f +- %.4f; length %.0f: %.0f mm\n",
                truth.brightness, found.brightness->value, found.brightness->sigma, uneven.shade, truth.shade,
                found.shade->value, found.shade->sigma, uneven.length_mm, found.length_mm);
    EXPECT_NEAR(found.brightness->value, truth.brightness, 0.15 * truth.brightness + 2 * found.brightness->sigma);
    EXPECT_LT(found.brightness->sigma, 0.4 * truth.brightness);
    EXPECT_NEAR(found.shade->value, truth.shade, 0.1 * truth.shade + 2 * found.shade->sigma);
    EXPECT_LT(found.shade->sigma, 0.3 * truth.shade);
    EXPECT_NEAR(std::log(found.length_mm / uneven.length_mm), 0, 0.6);
    EXPECT_EQ(found.diameter.has_value(), pixels_per_mm > 6);
    if (!found.diameter) continue;
    std::printf("diameter %.4f (%.4f): %.4f +- %.4f\n", uneven.diameter, truth.diameter, found.diameter->value,
                found.diameter->sigma);
    EXPECT_NEAR(found.diameter->value, truth.diameter, 3 * found.diameter->sigma);
  }
}

TEST(IrregularityTest, AnEvenThreadIsEven) {
  std::mt19937 random(kIrregularitySeed + 1);
  const WrappedSpool spool{.turns = 60, .thread_diameter_mm = 0.5};
  Photographs even = photographs_of(spool, {0, 0, 100}, 4, 0.3, random);
  even.twins.darkening = {kDarkening, 0.01, 0};
  const Irregularity found = measure_irregularity(spool, even.views, even.twins);
  ASSERT_TRUE(found.brightness);
  EXPECT_LT(found.brightness->value, 0.01);
  EXPECT_FALSE(found.diameter) << "two pixels to a turn";
}

TEST(IrregularityTest, WhatCannotBeToldIsNot) {
  std::mt19937 random(kIrregularitySeed + 2);
  const WrappedSpool spool{.turns = 30, .thread_diameter_mm = 0.5};
  Photographs few = photographs_of(spool, {0.2, 0, 100}, 3, 0.1, random);
  FittedTwins white = few.twins;
  white.darkening = {0.001, 0, 0};
  EXPECT_FALSE(measure_irregularity(spool, few.views, white).shade) << "a white thread does not get darker";
  FittedTwins hidden = few.twins;
  hidden.shaded = [&](std::size_t view, const std::vector<double>&) { return few.twins.even.at(view); };
  EXPECT_FALSE(measure_irregularity(spool, few.views, hidden).shade) << "shades that no picture shows";
  for (std::size_t i = 3; i < few.views.size(); ++i) few.views[i].transmission = true;
  EXPECT_FALSE(measure_irregularity(spool, few.views, few.twins).brightness);
}

}  // namespace
}  // namespace inversion
