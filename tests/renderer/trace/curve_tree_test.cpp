// The tree of curves against what curves are: balls along their axis, cylinders; and against Embree's round curves.
#include "renderer/trace/curve_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "renderer/trace/ray_scene.h"
#include "tests/renderer/trace/embree_curves.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr unsigned kCurveSeed = 20261130;

Vector3f any_direction(std::mt19937& random) {
  std::normal_distribution<float> n;
  return Vector3f(n(random), n(random), n(random)).normalized();
}

// Closed curves of one thickness each, bent no more sharply than they are thick.
CurveSet random_rings(std::mt19937& random, int count, float reach, Vector3f middle) {
  std::uniform_real_distribution<float> u(-1, 1);
  CurveSet set;
  for (int ring = 0; ring < count; ++ring) {
    const Vector3f centre = middle + reach * Vector3f(u(random), u(random), u(random)), x = any_direction(random),
                   y = x.unitOrthogonal(), z = x.cross(y);
    const float size = 2 + u(random), radius = 0.15f + 0.1f * u(random);
    constexpr int kPoints = 9;
    const auto first = static_cast<std::uint32_t>(set.control_points.size());
    for (int k = 0; k < kPoints + 3; ++k) {
      const float angle = 2 * static_cast<float>(M_PI) * static_cast<float>(k % kPoints) / kPoints;
      const Vector3f at = centre + size * (std::cos(angle) * x + std::sin(angle) * y + 0.4f * std::cos(2 * angle) * z);
      set.control_points.emplace_back(at.x(), at.y(), at.z(), radius);
    }
    for (std::uint32_t k = 0; k < kPoints; ++k) set.segments.push_back(first + k);
  }
  return set;
}

// Where a ray enters the balls of the curve's radius along its axis, whose hull a curve of one thickness is.
class Balls {
 public:
  explicit Balls(const CurveSet& set) {
    constexpr int kSteps = 400;
    for (const std::uint32_t begin : set.segments)
      for (int i = 0; i < kSteps; ++i) {
        const double u = static_cast<double>(i) / kSteps, w = 1 - u;
        const Vector4f* p = &set.control_points[begin];
        const Eigen::Vector4d at = (w * w * w * p[0].cast<double>() + (4 + 3 * u * u * (u - 2)) * p[1].cast<double>() +
                                    (4 + 3 * w * w * (w - 2)) * p[2].cast<double>() + u * u * u * p[3].cast<double>()) /
                                   6;
        balls_.push_back(at);
      }
  }
  // Infinite where it meets none. `touching`: it passes an axis at between .98 and 1.02 radii, where a little of
  // anything decides whether and where it enters.
  double entry(const Ray& ray, bool& touching) const {
    const Vector3d origin = ray.origin.cast<double>(), direction = ray.direction.cast<double>();
    double nearest = std::numeric_limits<double>::infinity(), before = 0, last = 0;
    touching = false;
    for (const Eigen::Vector4d& ball : balls_) {
      const Vector3d to = ball.head<3>() - origin;
      const double along = to.dot(direction), away = (to - along * direction).norm(), share = away / ball.w();
      // Nearest to the axis at the last ball.
      touching |= last < before && last < share && std::abs(last - 1) < 0.02;
      before = last, last = share;
      if (away < ball.w())
        if (const double t = along - std::sqrt(ball.w() * ball.w() - away * away); t > 0)
          nearest = std::min(nearest, t);
    }
    return nearest;
  }

 private:
  std::vector<Eigen::Vector4d> balls_;
};

TEST(CurveTreeTest, RaysEnterRandomRingsWhereTheirBallsAre) {
  std::mt19937 random(kCurveSeed);
  std::printf("seed %u\n", kCurveSeed);
  struct Place {
    float away, from;  // of the rings from the origin, of the rays from the rings: both are rounded
    double tolerance_mm;
  };
  for (const auto& [away, from_mm, tolerance_mm] : {Place{0, 12, 2e-4}, {200, 12, 4e-4}, {0, 800, 6e-4}}) {
    const CurveSet rings = random_rings(random, 40, 5, away * any_direction(random));
    const Balls balls(rings);
    const RayScene scene({.curves = {rings}});
    const Vector3f middle = scene.bounds().center().cast<float>();
    int met = 0, compared = 0, wrong = 0;
    for (int i = 0; i < 1500; ++i) {
      const Vector3f from = middle + from_mm * any_direction(random), to = middle + 4 * any_direction(random);
      const Ray ray{from, (to - from).normalized()};
      bool touching = false;
      const double expected = balls.entry(ray, touching);
      const auto hit = scene.intersect(ray);
      if (touching) continue;
      ++compared;
      met += hit.has_value();
      const bool meets = std::isfinite(expected);
      wrong += hit.has_value() != meets || scene.occluded(ray, from_mm + 100) != meets ||
               (meets && std::abs(static_cast<double>(hit->distance) - expected) > tolerance_mm);
    }
    std::printf("%d compared, %d met, %d wrong\n", compared, met, wrong);
    EXPECT_GT(met, 200);
    EXPECT_EQ(wrong, 0);
  }
}

struct Difference {
  int met = 0, different = 0;
};

// What rays from everywhere, and from where they have met something, meet in both.
Difference difference(const std::vector<CurveSet>& curves, int rays, std::mt19937& random, float tolerance_mm) {
  const RayScene scene({.curves = curves});
  EmbreeCurves embree(curves);
  const Vector3f middle = scene.bounds().center().cast<float>(), size = scene.bounds().sizes().cast<float>();
  std::uniform_real_distribution<float> u(-0.6f, 0.6f);
  Difference d;
  const auto compare = [&](const Ray& ray) {
    const auto ours = scene.intersect(ray);
    const auto theirs = embree.nearest(ray);
    EXPECT_EQ(scene.occluded(ray, 1e4f), ours.has_value());
    if (!ours && !theirs) return ours;
    ++d.met;
    d.different += ours.has_value() != theirs.has_value() ||
                   (ours && (std::abs(ours->distance - theirs->distance) > tolerance_mm ||
                             std::get<CurvePoint>(ours->point).curve_set != theirs->set));
    return ours;
  };
  for (int i = 0; i < rays; ++i) {
    const Vector3f from = middle + size.cwiseProduct(Vector3f(u(random), u(random), u(random)));
    const auto hit = compare({from, any_direction(random)});
    if (!hit) continue;
    const auto& point = std::get<CurvePoint>(hit->point);
    Vector3f onwards = any_direction(random);
    if (onwards.dot(point.normal) < 0.05f) continue;
    compare({point.position, onwards});
  }
  std::printf("%d met, %d differently\n", d.met, d.different);
  return d;
}

// Open curves whose radius changes, some of them straight and long.
CurveSet random_lines(std::mt19937& random, int count) {
  std::uniform_real_distribution<float> u(-1, 1);
  CurveSet set;
  for (int line = 0; line < count; ++line) {
    const Vector3f start = 5 * Vector3f(u(random), u(random), u(random)), along = any_direction(random),
                   side = along.unitOrthogonal();
    const float bend = line % 3 ? 0.5f : 0.0f, step = line % 3 ? 1.0f : 4.0f;
    std::vector<Vector4f> points;
    for (int k = 0; k < 6; ++k) {
      const Vector3f at = start + step * static_cast<float>(k) * along + bend * u(random) * side;
      points.emplace_back(at.x(), at.y(), at.z(), 0.2f + (line % 2 ? 0.05f * u(random) : 0.0f));
    }
    set.add_clamped_curve(points);
  }
  return set;
}

TEST(CurveTreeTest, RaysMeetWhatTheyMeetOfEmbreesCurves) {
  std::mt19937 random(kCurveSeed);
  std::printf("seed %u\n", kCurveSeed);
  const auto expect_alike = [&](const std::vector<CurveSet>& curves, int rays) {
    const Difference d = difference(curves, rays, random, 5e-3f);
    EXPECT_GT(d.met, 10000);
    EXPECT_LE(d.different, d.met / 500);  // rays that only touch a curve, or graze its open end
  };
  expect_alike({random_rings(random, 100, 4, Vector3f::Zero())}, 60000);
  expect_alike({random_lines(random, 200), random_lines(random, 100)}, 200'000);
  // Cut by two planes, and stretched, turned and moved.
  CurveSet cut = random_lines(random, 200), placed = random_lines(random, 150);
  cut.cut = {{1, 0, 0, 3}, {0, -0.6f, 0.8f, 2}};
  placed.placed = Eigen::Translation3f(2, -3, 1) * Eigen::AngleAxisf(0.7f, Vector3f(1, 2, 2).normalized()) *
                  Eigen::Scaling(Vector3f(1.3f, 0.8f, 1));
  expect_alike({cut, placed, random_lines(random, 50)}, 400'000);
}

TEST(CurveTreeTest, DistancesInAPlacedTreeAreThoseOfTheWorld) {
  CurveSet set;
  set.add_clamped_curve({{-30, 0, 0, 0.5f}, {0, 0, 0, 0.5f}, {30, 0, 0, 0.5f}});
  set.placed = Eigen::Translation3f(0, 0, 1) * Eigen::Scaling(Vector3f(1, 1, 3));
  const RayScene scene({.curves = {set}});
  const auto hit = scene.intersect({{0, 0, 10}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 10 - 2.5, 1e-4);
  EXPECT_TRUE(scene.occluded({{0, 0, 10}, {0, 0, -1}}, 7.6f));
  EXPECT_FALSE(scene.occluded({{0, 0, 10}, {0, 0, -1}}, 7.4f));
  EXPECT_FALSE(scene.intersect({{0, 0.51f, 10}, {0, 0, -1}}));
  EXPECT_NEAR(scene.bounds().max().z(), 2.5, 0.01);
}

TEST(CurveTreeTest, AControlPointThatIsNoNumberIsRefused) {
  CurveSet set = {};
  set.add_clamped_curve({{0, 0, 0, 0.5f}, {1, 0, 0, 0.5f}, {2, std::nanf(""), 0, 0.5f}});
  try {
    RayScene scene({.curves = {set}});
    FAIL() << "was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("control point that is no number"), std::string::npos) << error.what();
  }
}

TEST(CurveTreeTest, WithoutCurvesNothingIsMet) {
  const RayScene none({.curves = {CurveSet{}}});
  EXPECT_FALSE(none.intersect({{0, 0, 10}, {0, 0, -1}}));
  EXPECT_FALSE(none.occluded({{0, 0, 10}, {0, 0, -1}}, 100));
}

}  // namespace
}  // namespace renderer
