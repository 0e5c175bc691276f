#include "renderer/weave/woven_patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "renderer/scene/cloth_shape.h"
#include "renderer/trace/ray_scene.h"
#include "renderer/weave/initial_patch.h"
#include "renderer/weave/patch_measures.h"
#include "tests/renderer/weave/relaxed_cloths.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// A straight yarn of radius 0.25 mm at x = 0 of the cloth that is drawn, alone in its cell.
RayScene straight_yarn(bool warp, double flatness) {
  Yarn yarn{.warp = warp, .radius_mm = 0.25, .flatness = flatness};
  for (int k = 0; k < 8; ++k) yarn.control_points.push_back(warp ? Vector3d(1, k / 4.0, 0) : Vector3d(k / 4.0, 1, 0));
  YarnPatch patch{.name = "straight", .period_x_mm = 2, .period_y_mm = 2, .yarns = {yarn}};
  Scene scene;
  scene.cloths.push_back({.surface = surface_of(SwatchShape{6, 6}, patch, Eigen::Isometry3d::Identity()),
                          .patch = patch,
                          .threads = {ThreadParameters{}}});
  return RayScene(std::move(scene));
}

TEST(WovenPatchTest, FlattenedYarnsAreDrawnAsEllipsesOfTheRoundYarnsArea) {
  for (const bool warp : {true, false}) {
    for (const double flatness : {1.0, 1.5, 3.0}) {
      const RayScene scene = straight_yarn(warp, flatness);
      const double wide = 0.25 * std::sqrt(flatness), high = 0.25 / std::sqrt(flatness);
      constexpr int kRays = 4000;
      double area = 0, worst_angle = 0;
      for (int i = 0; i < kRays; ++i) {
        const double offset = 0.6 * ((i + 0.5) / kRays * 2 - 1), along = 0.1;
        const auto at = [&](double z) {
          return warp ? Vector3f(static_cast<float>(offset), static_cast<float>(along), static_cast<float>(z))
                      : Vector3f(static_cast<float>(along), static_cast<float>(offset), static_cast<float>(z));
        };
        const auto above = scene.intersect({at(2), -Vector3f::UnitZ()}),
                   below = scene.intersect({at(-2), Vector3f::UnitZ()});
        EXPECT_EQ(above.has_value(), below.has_value());
        if (!above || !below) continue;
        area += (4 - static_cast<double>(above->distance) - static_cast<double>(below->distance)) * 1.2 / kRays;
        const double x = offset / wide;
        if (std::abs(x) > 0.9) continue;
        Vector3d normal(x / wide, 0, std::sqrt(1 - x * x) / high);
        if (!warp) normal = Vector3d(0, normal.x(), normal.z());
        const Vector3f& found = std::get<CurvePoint>(above->point).normal;
        worst_angle = std::max(worst_angle, normal.normalized().cross(found.cast<double>()).norm());
      }
      std::printf("%s, flatness %.1f: area %.6f mm^2 (round %.6f), normals within %.1e rad\n", warp ? "warp" : "weft",
                  flatness, area, std::numbers::pi / 16, worst_angle);
      EXPECT_NEAR(area / (std::numbers::pi / 16), 1, 1e-3);
      EXPECT_LT(worst_angle, 1e-5);  // floats
      EXPECT_FALSE(scene.intersect({Vector3f(0, 0, 0), Vector3f(0.6f, 0.5f, 0.62f).normalized()})) << "from inside";
    }
  }
}

TEST(WovenPatchTest, BruteForceStretchesFlattenedYarnsOnSwatchesAndRefusesToBendThem) {
  Draft draft = plain_draft();
  draft.warp.flatness = 2;
  const std::vector<ScatteringModel> threads{ThreadParameters{}};
  const YarnPatch patch = initial_patch(draft);
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  int stretched = 0;
  for (const CurveSet& curves : explicit_curves(SwatchShape{6, 6}, patch, threads, here))
    if (!curves.placed.linear().isIdentity(1e-6F)) ++stretched;
  EXPECT_EQ(stretched, 1) << "the warp";
  EXPECT_THROW(explicit_curves(CylinderShape{}, patch, threads, here), std::runtime_error);
}

TEST(WovenPatchTest, YarnsFlattenTheMoreTheSofterTheyAreAndKeepTheirArea) {
  Draft draft = plain_cloth(1.2, 1.0, 0.5);
  double flattest = 1, thinnest = relax(draft).patch.thickness_mm;
  for (const double modulus : {16.0, 4.0, 1.0}) {
    draft.transverse_modulus_n_mm2 = modulus;
    const RelaxedPatch cloth = woven_patch(draft);
    expect_at_rest(cloth);
    double flatness = 0;
    for (const Yarn& yarn : cloth.patch.yarns) {
      flatness = std::max(flatness, yarn.flatness);
      EXPECT_NEAR(half_width(yarn) * half_height(yarn) / (yarn.radius_mm * yarn.radius_mm), 1, 1e-12);
      // The law itself, at the loads of the last relaxation; iterated to 1e-3.
      const auto i = &yarn - cloth.patch.yarns.data();
      const double load = cloth.report.contact_loads_n[i] / 2 / spline_length(center_line(cloth.patch, yarn));
      const double pitch = yarn.warp ? 1.2 : 1.0;
      const double expected = std::min(std::pow(1 + load / (modulus * 0.5), 2), pitch * pitch / 0.25);
      EXPECT_NEAR(yarn.flatness / expected, 1, 3e-3) << modulus;
    }
    std::printf("%4.0f N/mm^2: flatness up to %.3f, thickness %.3f mm, overlap %.2f %%\n", modulus, flatness,
                cloth.patch.thickness_mm, 100 * cloth.report.overlap);
    EXPECT_GT(flatness, flattest);
    EXPECT_LT(cloth.patch.thickness_mm, thinnest);
    EXPECT_LE(cloth.report.overlap, kMostOverlap);
    flattest = flatness;
    thinnest = cloth.patch.thickness_mm;
  }
}

TEST(WovenPatchTest, StrandsKeepTheirPlacesInTheYarn) {
  const YarnPatch yarns = relax(plain_cloth(1.25, 1.25, 0.5)).patch;
  const std::vector<Eigen::Vector2d> places{{0, 0}, {0.15, 0}, {0, -0.18}, {-0.1, 0.12}};
  const std::vector<Strands> bundles(yarns.yarns.size(), {.radius_mm = 0.05, .places = places});
  const YarnPatch divided = with_strands(yarns, bundles);
  ASSERT_EQ(divided.yarns.size(), yarns.yarns.size() * places.size());
  for (std::size_t y = 0; y < yarns.yarns.size(); ++y) {
    const Yarn& yarn = yarns.yarns[y];
    const PeriodicSpline center = center_line(yarns, yarn);
    const Vector3d side = yarn.warp ? Vector3d::UnitX() : Vector3d::UnitY();
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Yarn& strand = divided.yarns[y * places.size() + k];
      EXPECT_EQ(strand.thread, yarn.thread);
      EXPECT_EQ(strand.radius_mm, 0.05);
      const PeriodicSpline line = center_line(divided, strand);
      for (int i = 0; i < 200; ++i) {
        const double t = i / 200.0 * static_cast<double>(center.control_points.size());
        const Vector3d offset = spline_value(line, t) - spline_value(center, t);
        const Vector3d third = spline_value(center, t, 1).cross(side).normalized();
        EXPECT_NEAR(offset.dot(side), places[k].x(), 2e-3);
        EXPECT_NEAR(offset.dot(third), places[k].y(), 4e-3);  // between knots the strand follows a spline of its own
      }
    }
  }
  EXPECT_THROW(with_strands(yarns, {}), std::invalid_argument);
  EXPECT_THROW(with_strands(yarns, std::vector<Strands>(yarns.yarns.size(), {.radius_mm = 0.3, .places = places})),
               std::runtime_error);
}

TEST(RepeatedTest, HasTheSameYarnsInEveryPeriod) {
  Draft draft = twill_draft(2, 1);
  draft.slubs = {.radius = 0.1};
  draft.unevenness.shades = 2, draft.slubs.shade_mm = 1;
  const YarnPatch once = woven_patch(draft).patch, all = repeated(once, 2, 3);
  ASSERT_EQ(once.yarns.size(), 6U);
  ASSERT_EQ(all.yarns.size(), 2U * 3U + 3U * 3U);
  EXPECT_DOUBLE_EQ(all.period_x_mm, 2 * once.period_x_mm);
  EXPECT_DOUBLE_EQ(all.period_y_mm, 3 * once.period_y_mm);
  for (std::size_t i = 0; i < all.yarns.size(); ++i) {
    const bool warp = i < 6;
    const std::size_t copy = warp ? i / 3 : (i - 6) / 3;
    const Yarn &yarn = all.yarns[i], &of = once.yarns[warp ? i % 3 : 3 + (i - 6) % 3];
    ASSERT_EQ(yarn.warp, warp);
    const Vector3d shift =
        static_cast<double>(copy) * (warp ? Vector3d(once.period_x_mm, 0, 0) : Vector3d(0, once.period_y_mm, 0));
    ASSERT_EQ(yarn.control_points.size(), (warp ? 3U : 2U) * of.control_points.size());
    for (double t = -3.3; t < 100; t += 1.7) {
      const Vector3d there = spline_value(center_line(once, of), t) + shift;
      EXPECT_LT((spline_value(center_line(all, yarn), t) - there).norm(), 1e-9) << "yarn " << i << " at " << t;
      EXPECT_NEAR(thickness(yarn, t), thickness(of, t), 1e-12);
      EXPECT_EQ(thread_of_segment(yarn, static_cast<int>(t)), thread_of_segment(of, static_cast<int>(t)));
    }
  }
}

TEST(WovenPatchTest, StrandsOfAFlatYarnAreRoundAndLieInItsSection) {
  YarnPatch yarns = relax(plain_cloth(1.25, 1.25, 0.5)).patch;
  for (Yarn& yarn : yarns.yarns) yarn.flatness = 2.25;  // 0.375 mm wide and 0.167 mm high, from the middle
  const std::vector<Eigen::Vector2d> places{{0.3, 0}, {0, -0.1}};
  const YarnPatch divided =
      with_strands(yarns, std::vector<Strands>(yarns.yarns.size(), {.radius_mm = 0.05, .places = places}));
  for (std::size_t y = 0; y < yarns.yarns.size(); ++y) {
    const PeriodicSpline center = center_line(yarns, yarns.yarns[y]);
    const Vector3d side = yarns.yarns[y].warp ? Vector3d::UnitX() : Vector3d::UnitY();
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Yarn& strand = divided.yarns[y * places.size() + k];
      EXPECT_EQ(strand.flatness, 1);
      const Vector3d offset = spline_value(center_line(divided, strand), 2) - spline_value(center, 2);
      EXPECT_NEAR(offset.dot(side), places[k].x(), 2e-3);
      EXPECT_NEAR(offset.norm(), places[k].norm(), 4e-3);
    }
  }
}

TEST(WovenPatchTest, PliesTouchEachOtherInsideTheirYarnAndRepeatWithThePatch) {
  const YarnPatch yarns = relax(plain_cloth(1.25, 1.25, 0.5)).patch;
  for (const int count : {2, 3, 5}) {
    const Plies plies{.count = count, .turns_per_mm = 0.9};
    const YarnPatch twisted = with_plies(yarns, plies);
    ASSERT_EQ(twisted.yarns.size(), yarns.yarns.size() * static_cast<std::size_t>(count));
    const double radius = ply_radius_mm(plies, 0.25);
    double least = 1, farthest = 0;
    for (std::size_t y = 0; y < yarns.yarns.size(); ++y) {
      const PeriodicSpline center = center_line(yarns, yarns.yarns[y]);
      const auto first = y * static_cast<std::size_t>(count);
      const PeriodicSpline a = center_line(twisted, twisted.yarns[first]),
                           b = center_line(twisted, twisted.yarns[first + 1]);
      const auto knots = static_cast<double>(a.control_points.size()),
                 knots_of_center = static_cast<double>(center.control_points.size());
      double turned = 0;
      Vector3d before = Vector3d::Zero();
      for (int i = 0; i <= 400; ++i) {
        const double share = i / 400.0;
        const Vector3d on_a = spline_value(a, share * knots), on_b = spline_value(b, share * knots);
        const Vector3d middle = spline_value(center, share * knots_of_center);
        least = std::min(least, (on_a - on_b).norm());
        farthest = std::max(farthest, (on_a - middle).norm() + radius);
        const Vector3d arm = on_a - middle, along = spline_value(center, share * knots_of_center, 1).normalized();
        if (i > 0) turned += std::atan2(before.cross(arm).dot(along), before.dot(arm));
        before = arm;
      }
      EXPECT_NEAR(std::abs(turned) / (2 * std::numbers::pi), std::round(0.9 * spline_length(center)),
                  0.01);  // whole turns
    }
    std::printf("%d plies of radius %.4f mm: centres at least %.4f mm apart, reach %.4f mm from the yarn's line\n",
                count, radius, least, farthest);
    // 12 points per turn: a spline's circle is good to 1e-4 of its radius; slopes of the knots' parameter add some
    EXPECT_NEAR(least / (2 * radius), 1, 0.01);
    EXPECT_NEAR(farthest / 0.25, 1, 0.01);
  }
}

TEST(WovenPatchTest, UnevenYarnsDifferBySeedOnlyAndAreAtRestAsDrafted) {
  Draft draft = plain_cloth(1.1, 1.1, 0.5);
  draft.warp.threads.assign(8, 1);
  const YarnPatch even = woven_patch(draft).patch, plain = relax(draft).patch;
  for (std::size_t i = 0; i < even.yarns.size(); ++i)
    EXPECT_EQ(even.yarns[i].control_points, plain.yarns[i].control_points);
  draft.unevenness = {.radius = 0.05, .pitch = 0.1, .shades = 3, .seed = 7};
  const RelaxedPatch a = woven_patch(draft), b = woven_patch(draft);
  draft.unevenness.seed = 8;
  const RelaxedPatch c = woven_patch(draft);
  expect_at_rest(a);
  double sum = 0;
  for (std::size_t i = 0; i < a.patch.yarns.size(); ++i) {
    const Yarn& yarn = a.patch.yarns[i];
    EXPECT_EQ(yarn.control_points, b.patch.yarns[i].control_points);
    EXPECT_NE(yarn.radius_mm, c.patch.yarns[i].radius_mm);
    EXPECT_EQ(yarn.thread / 3, yarn.warp ? 1 : 0);
    sum += std::abs(yarn.radius_mm / 0.25 - 1);
    EXPECT_LE(std::abs(yarn.radius_mm / 0.25 - 1), 2 * 0.05 + 1e-12);
  }
  EXPECT_GT(sum, 0.01 * static_cast<double>(a.patch.yarns.size()));
  EXPECT_LE(a.report.overlap, kMostOverlap);
}

TEST(WovenPatchTest, APlyThatIsThickerThanItsYarnIsRefusedInOneLine) {
  Draft draft = plain_draft();
  draft.plies = {.count = 2, .radius_mm = 1};
  EXPECT_THROW(woven_patch(draft), std::runtime_error);
}

}  // namespace
}  // namespace renderer
