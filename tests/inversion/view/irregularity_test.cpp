// Sheets of thread whose brightness and thickness are known at every place, drawn pixel by pixel without the renderer:
// unevenness, lengths, noise and cameras drawn at random.
#include "inversion/view/irregularity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
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
  double brightness, diameter, length_mm;
};

struct Photographs {
  std::vector<View> views;
  std::vector<cv::Mat3f> even;
};

// What the waves are on this thread itself, which is not as long as their mean would need.
struct Truth {
  double brightness, diameter;
};

double spread(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double value : values) sum += value, squares += value * value;
  const auto count = static_cast<double>(values.size());
  return std::sqrt(squares / count - sum * sum / (count * count));
}

std::pair<Photographs, Truth> photographs_of(const WrappedSpool& spool, const Uneven& uneven, double pixels_per_mm,
                                             double noise, std::mt19937& random) {
  const Wave bright(uneven.length_mm, random), thick(uneven.length_mm, random);
  const double turn_mm = 2 * (spool.frame_width_mm + spool.frame_depth_mm), d = spool.thread_diameter_mm;
  std::vector<double> edges{0}, thickness, brightness;
  for (int turn = 0; turn < spool.turns; ++turn) {
    thickness.push_back(1 + uneven.diameter * thick.at(turn * turn_mm));
    brightness.push_back(uneven.brightness * bright.at(turn * turn_mm));
    edges.push_back(edges.back() + d * thickness.back());
  }
  for (double& edge : edges) edge -= edges.back() / 2;
  std::pair<Photographs, Truth> made{{}, {spread(brightness), spread(thickness)}};
  std::uniform_real_distribution<double> anywhere(-1, 1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < kSheetViews; ++i) {
    View view;
    const double azimuth = 45 * anywhere(random) * renderer::kDegree,
                 elevation = 20 * anywhere(random) * renderer::kDegree;
    const Vector3d eye = 600 * Vector3d(std::cos(elevation) * std::cos(azimuth),
                                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    view.camera = renderer::look_at(eye, Vector3d::Zero(), i % 2 == 0 ? Vector3d::UnitZ() : Vector3d::UnitY());
    const int width = static_cast<int>(74 * pixels_per_mm), height = static_cast<int>(60 * pixels_per_mm);
    view.camera.width = i % 2 == 0 ? width : height, view.camera.height = i % 2 == 0 ? height : width;
    view.camera.fx = view.camera.fy = 600 * pixels_per_mm;
    view.camera.cx = (view.camera.width - 1) / 2.0, view.camera.cy = (view.camera.height - 1) / 2.0;
    view.image.create(view.camera.height, view.camera.width);
    view.mask.create(view.camera.height, view.camera.width);
    cv::Mat3f even(view.image.size());
    for (int row = 0; row < view.image.rows; ++row)
      for (int column = 0; column < view.image.cols; ++column) {
        const Vector3d way =
            view.camera.world_from_camera.linear() *
            Vector3d((column - view.camera.cx) / view.camera.fx, (row - view.camera.cy) / view.camera.fy, 1);
        const Vector3d at = eye + (kLitAt * d - eye.x()) / way.x() * way;
        const auto turn =
            static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), at.z()) - edges.begin());
        const bool on = turn >= 1 && turn < edges.size() && std::abs(at.y()) < spool.frame_width_mm / 2 - 1;
        view.mask(row, column) = on ? 255 : 0;
        if (!on) continue;
        // Light that changes slowly and differs from what the model takes it for, and a crown on each turn.
        const double slow = 1 + 0.01 * at.y() + 0.02 * at.z(), wrong = 1 + 0.004 * at.y() - 0.0005 * at.z() * at.z();
        const double across = (at.z() - edges[turn - 1]) / (edges[turn] - edges[turn - 1]) - 0.5;
        const double crown = 0.4 + 0.6 * std::cos(std::numbers::pi * across);
        const double darker = std::exp(uneven.brightness * bright.at(static_cast<double>(turn - 1) * turn_mm + at.y()));
        const auto own = static_cast<float>(slow * wrong * crown * darker * (1 + noise * normal(random)));
        const auto twins = static_cast<float>(slow * 0.78 * (1 + noise * normal(random)));
        view.image(row, column) = {own, own, own};
        even(row, column) = {twins, twins, twins};
      }
    made.first.views.push_back(view);
    made.first.even.push_back(even);
  }
  return made;
}

TEST(IrregularityTest, ShadeThicknessAndLengthAreThoseOfTheThread) {
  std::printf("seed %u\n", kIrregularitySeed);
  std::mt19937 random(kIrregularitySeed);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  const WrappedSpool spool{.turns = 60, .thread_diameter_mm = 0.5};
  for (int trial = 0; trial < 4; ++trial) {
    const Uneven uneven{
        .brightness = between(0.03, 0.2), .diameter = between(0.02, 0.06), .length_mm = between(30, 400)};
    const auto [photographs, truth] = photographs_of(spool, uneven, 7, between(0.05, 0.2), random);
    const Irregularity found =
        measure_irregularity(spool, photographs.views, photographs.even, Eigen::Array3d(0.5, 0.5, 0.5));
    ASSERT_TRUE(found.brightness && found.shade && found.diameter);
    std::printf(
        "brightness %.4f (%.4f on this thread): %.4f +- %.4f; diameter %.4f (%.4f): %.4f +- %.4f; length %.0f: "
        "%.0f mm\n",
        uneven.brightness, truth.brightness, found.brightness->value, found.brightness->sigma, uneven.diameter,
        truth.diameter, found.diameter->value, found.diameter->sigma, uneven.length_mm, found.length_mm);
    EXPECT_NEAR(found.brightness->value, truth.brightness, 0.15 * truth.brightness + 2 * found.brightness->sigma);
    EXPECT_LT(found.brightness->sigma, 0.4 * truth.brightness);
    EXPECT_NEAR(found.shade->value, found.brightness->value / 0.5, 1e-6) << "all channels fall alike";
    EXPECT_NEAR(found.diameter->value, truth.diameter, 3 * found.diameter->sigma);
    EXPECT_NEAR(std::log(found.length_mm / uneven.length_mm), 0, 0.6);
  }
}

TEST(IrregularityTest, AnEvenThreadIsEven) {
  std::mt19937 random(kIrregularitySeed + 1);
  const WrappedSpool spool{.turns = 60, .thread_diameter_mm = 0.5};
  const Photographs even = photographs_of(spool, {0, 0, 100}, 4, 0.3, random).first;
  const Irregularity found = measure_irregularity(spool, even.views, even.even, Eigen::Array3d(0.5, 0.01, 0));
  ASSERT_TRUE(found.brightness);
  EXPECT_LT(found.brightness->value, 0.01);
  EXPECT_FALSE(found.diameter) << "two pixels to a turn";
}

TEST(IrregularityTest, WhatCannotBeToldIsNot) {
  std::mt19937 random(kIrregularitySeed + 2);
  const WrappedSpool spool{.turns = 30, .thread_diameter_mm = 0.5};
  Photographs few = photographs_of(spool, {0.1, 0, 100}, 3, 0.1, random).first;
  EXPECT_FALSE(measure_irregularity(spool, few.views, few.even, Eigen::Array3d(0.001, 0, 0)).shade)
      << "a white thread does not get darker";
  for (std::size_t i = 3; i < few.views.size(); ++i) few.views[i].transmission = true;
  EXPECT_FALSE(measure_irregularity(spool, few.views, few.even, Eigen::Array3d(0.5, 0.5, 0.5)).brightness);
}

}  // namespace
}  // namespace inversion
