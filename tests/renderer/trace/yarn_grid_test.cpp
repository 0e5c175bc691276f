// The patch's own intersector against Embree's round curves, ray by ray.
#include "renderer/trace/yarn_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "renderer/scene/patch_curves.h"
#include "renderer/trace/curve_geometry.h"
#include "tests/renderer/trace/cloth_scenes.h"
#include "tests/renderer/trace/embree_curves.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

std::vector<ColumnYarns> column_of(const YarnPatch& patch) {
  std::vector<ColumnYarns> yarns;
  for (const RoundYarns& part : round_yarns_of(patch)) {
    yarns.push_back({cell_curves_of(part.patch, 0), 0});
    yarns.back().curves.placed = Eigen::Scaling(Vector3f(part.stretch.cast<float>()));
  }
  return yarns;
}

// A draft of one thread.
YarnPatch one_thread(YarnPatch patch) {
  for (Yarn& yarn : patch.yarns) yarn.thread = 0;
  return patch;
}

YarnPatch flattened(YarnPatch patch) {
  for (std::size_t i = 0; i < patch.yarns.size(); ++i) patch.yarns[i].flatness = i % 2 ? 1.4 : 1.2;
  return patch;
}

YarnPatch slubbed(YarnPatch patch) {
  for (Yarn& yarn : patch.yarns)
    for (std::size_t k = 0; k < yarn.control_points.size(); ++k)
      yarn.thickness.push_back(1 + 0.15 * std::sin(2 * std::numbers::pi * static_cast<double>(k) /
                                                   static_cast<double>(yarn.control_points.size())));
  return patch;
}

// A yarn patch in both intersectors; Embree's is tiled `tiles` times each way round the origin.
struct Both {
  static constexpr int kTiles = 12;
  explicit Both(const YarnPatch& patch)
      : grid(column_of(patch), {patch.period_x_mm, patch.period_y_mm}),
        curves(brute_force_scene(SwatchShape{kTiles * patch.period_x_mm, kTiles * patch.period_y_mm}, patch,
                                 {FiberParameters{}})
                   .curves),
        embree(curves),
        corner(kTiles / 2 * patch.period_x_mm, kTiles / 2 * patch.period_y_mm, 0) {}
  YarnGrid grid;
  std::vector<CurveSet> curves;
  EmbreeCurves embree;
  Vector3d corner;  // of the tiles, from the origin

  // The point of a hit of Embree's.
  CurvePoint point_of(const EmbreeCurves::Hit& hit, const Ray& ray) const {
    return point_on_curve(curves[hit.set], hit.segment, hit.u, hit.normal, ray, hit.distance);
  }
};

const YarnPatch kPatches[] = {one_thread(plain_patch()), one_thread(satin_patch()),
                              one_thread(flattened(plain_patch())), one_thread(slubbed(plain_patch()))};

Vector3d direction_of(std::mt19937& random) {
  std::normal_distribution<double> n;
  return Vector3d(n(random), n(random), n(random)).normalized();
}

TEST(YarnGridTest, RaysMeetWhatTheyMeetOfEmbreesCurves) {
  for (const YarnPatch& patch : kPatches) {
    Both both(patch);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-1, 1);
    int met = 0, different = 0;
    for (int i = 0; i < 40000; ++i) {
      const Vector3d origin(1.5 * u(random), 1.5 * u(random), 0.7 * u(random)), direction = direction_of(random);
      const float length = i % 2 ? 3.0f : 0.5f;
      const auto a = both.grid.nearest(both.corner + origin, direction, length);
      const Ray ray{origin.cast<float>(), direction.cast<float>()};
      const auto b = both.embree.nearest(ray, length);
      EXPECT_EQ(both.grid.occluded(both.corner + origin, direction, length), a.has_value());
      if (!a && !b) continue;
      ++met;
      if (!a || !b) {
        ++different;
        continue;
      }
      // Embree finds round curves to 0.002 radii, more where it only touches them.
      different += std::abs(a->distance - b->distance) > 3e-3f;
      // A CurvePoint's normal is that of a round yarn without slubs.
      const Vector3f normal = a->normal.normalized();
      const bool even = patch.yarns[0].flatness == 1 && patch.yarns[0].thickness.empty();
      if (even && normal.dot(direction.cast<float>()) < -0.1f)
        different += (normal - both.point_of(*b, ray).normal).norm() > 2e-2f;
    }
    EXPECT_GT(met, 15000);
    EXPECT_LE(different, met / 2000);  // rays that only touch a yarn
    std::printf("%s: %d met, %d differently\n", patch.name.c_str(), met, different);
  }
}

TEST(YarnGridTest, ARayThatStartsAtAHitMeetsTheNextYarnOnly) {
  for (const YarnPatch& patch : kPatches) {
    Both both(patch);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> u(-1, 1);
    int started = 0, different = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vector3d above(1.5 * u(random), 1.5 * u(random), 2), down(0.3 * u(random), 0.3 * u(random), -1);
      const Ray ray{above.cast<float>(), down.normalized().cast<float>()};
      const auto hit = both.embree.nearest(ray);
      if (!hit) continue;
      ++started;
      const Vector3f start = both.point_of(*hit, ray).position;
      const Vector3d direction = direction_of(random);
      const auto a = both.grid.nearest(both.corner + start.cast<double>(), direction, 2.0f);
      const auto b = both.embree.nearest({start, direction.cast<float>()}, 2);
      different += a.has_value() != b.has_value() || (a && std::abs(a->distance - b->distance) > 5e-3f);
    }
    EXPECT_GT(started, 10000);
    EXPECT_LE(different, started / 1000);  // rays that only touch a yarn
    std::printf("%s: %d started, %d differently\n", patch.name.c_str(), started, different);
  }
}

// One straight yarn of radius 0.25 along x at y = 0.5, in a cell of 1 x 1 mm.
YarnPatch straight_yarn() {
  Yarn yarn{.warp = false, .radius_mm = 0.25};
  for (int k = 0; k < 5; ++k) yarn.control_points.emplace_back(0.2 * k, 0.5, 0);
  return {.name = "straight", .period_x_mm = 1, .period_y_mm = 1, .yarns = {yarn}};
}

TEST(YarnGridTest, ACylinderIsMetWhereItIsUpToItsSilhouette) {
  const YarnGrid grid(column_of(straight_yarn()), {1, 1});
  for (double h = -1.2; h < 1.2; h += 0.0007) {
    if (std::abs(std::abs(h) - 1) < 1e-4) continue;
    for (const double slant : {0.0, 0.9, -8.0}) {
      const Vector3d direction = Vector3d(slant, 0, -1).normalized();
      const double z = std::sqrt(std::max(0.0, 1 - h * h)) * 0.25, way = (0.6 - z) * std::hypot(1, slant);
      const auto hit = grid.nearest({3.3, -7.5 + 0.25 * h, 0.6}, direction, 20);
      ASSERT_EQ(hit.has_value(), std::abs(h) < 1) << h << ' ' << slant;
      if (!hit) continue;
      EXPECT_NEAR(hit->distance, way, 2e-5 * way + 2e-5 / (0.01 + std::sqrt(1 - h * h))) << h << ' ' << slant;
      EXPECT_LT((hit->normal.normalized() - Vector3f(0, static_cast<float>(h), static_cast<float>(4 * z))).norm(),
                1e-3f);
      EXPECT_EQ(hit->tile.y(), -8);
    }
  }
}

TEST(YarnGridTest, RaysAlongTheYarnTheAxesAndTheCellsMeetNoMoreThanIsThere) {
  const YarnGrid grid(column_of(straight_yarn()), {1, 1});
  // Along the yarn beside it and inside it; along cell borders; through the gap.
  EXPECT_FALSE(grid.nearest({0.1, 0.5, 0.2501}, {1, 0, 0}, 50));
  EXPECT_FALSE(grid.nearest({0.1, 0.5, 0.1}, {1, 0, 0}, 50));
  EXPECT_FALSE(grid.nearest({0, 0, 5}, {0, 0, -1}, 10));
  EXPECT_FALSE(grid.nearest({0, 0.0, 0}, {1, 0, 0}, 50));
  const auto across = grid.nearest({0, 0, 0}, {0, 1, 0}, 50);
  ASSERT_TRUE(across);
  EXPECT_NEAR(across->distance, 0.25, 1e-4);
  EXPECT_FALSE(grid.nearest({0, 0, 0}, {0, 1, 0}, 0.24f));
  EXPECT_TRUE(grid.occluded({0, 0, 0}, {0, 1, 0}, 0.26f));
  EXPECT_FALSE(grid.occluded({0, 0, 0}, {0, 1, 0}, 0.24f));
}

TEST(YarnGridTest, DistancesAreInUnitsOfTheDirection) {
  const YarnGrid grid(column_of(straight_yarn()), {1, 1});
  const auto hit = grid.nearest({0.5, 0.5, 1}, {0, 0, -2}, 5);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 0.375, 1e-5);
}

TEST(YarnGridTest, FarFromTheFirstPeriodItIsTheSame) {
  const YarnPatch patch = one_thread(satin_patch());
  const YarnGrid grid(column_of(patch), {patch.period_x_mm, patch.period_y_mm});
  std::mt19937 random(6);
  std::uniform_real_distribution<double> u(0, 5);
  int met = 0, different = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d at(u(random), u(random), 0.5 - 0.2 * u(random)), direction = direction_of(random);
    const Vector3d far = at + Vector3d(-9000 * patch.period_x_mm, 7000 * patch.period_y_mm, 0);
    const auto a = grid.nearest(at, direction, 3), b = grid.nearest(far, direction, 3);
    met += a.has_value();
    different += a.has_value() != b.has_value() || (a && std::abs(a->distance - b->distance) > 1e-4f);
  }
  EXPECT_GT(met, 1500);
  EXPECT_LE(different, 2);
}

}  // namespace
}  // namespace renderer
