#include "renderer/trace/cloth_shell.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "renderer/scene/cloth_shape.h"

namespace renderer {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr SurfaceRange kHeights{-0.4, 0.6};

YarnPatch empty_patch() {
  return {.name = "empty", .period_x_mm = 2, .period_y_mm = 3};
}

ClothShell shell_of(const ClothShape& shape) {
  return make_shell(surface_of(shape, empty_patch(), Isometry3d::Identity()), kHeights);
}

const ShellCell* cell_at(const ClothShell& shell, const Vector3d& world) {
  for (const ShellCell& cell : shell.cells)
    if ((cell.inside_from_world * world.homogeneous()).topRows(cell.faces).minCoeff() > -1e-9) return &cell;
  return nullptr;
}

TEST(ClothShellTest, AFlatSwatchMapsToThePatchWithoutDistortion) {
  const ClothShell shell = shell_of(SwatchShape{40, 60});
  for (const Vector3d& at : {Vector3d(-19.9, -29.9, -0.39), Vector3d(0, 0, 0), Vector3d(12, -7, 0.55)}) {
    const ShellCell* cell = cell_at(shell, at);
    ASSERT_TRUE(cell);
    EXPECT_LT((cell->patch_from_world * at.homogeneous() - (at + Vector3d(20, 30, 0))).norm(), 1e-9);
    EXPECT_LT((frame_at(shell, *cell, at) - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  }
  EXPECT_FALSE(cell_at(shell, {20.1, 0, 0}));
  EXPECT_FALSE(cell_at(shell, {0, 0, 0.61}));
}

TEST(ClothShellTest, OnACylinderHeightsGoOutwardsAndThePatchGoesRound) {
  const ClothShell shell = shell_of(CylinderShape{41, 60});
  const double around_mm = 2 * std::lround(std::numbers::pi * 41);
  for (double angle : {0.001, 0.7, 2.0, 3.9, 6.28}) {
    const Vector3d normal(std::cos(angle), std::sin(angle), 0), along(-std::sin(angle), std::cos(angle), 0);
    for (double height : {-0.39, 0.0, 0.5}) {
      const Vector3d at = (41 + height) * normal + Vector3d(0, 0, 23);
      const ShellCell* cell = cell_at(shell, at);
      ASSERT_TRUE(cell) << angle << ' ' << height;
      // Inside a face, places are interpolated between corners 1 mm apart. Faces of 1.4 degrees lie up to 3 um inside
      // the cylinder.
      EXPECT_LT(
          (cell->patch_from_world * at.homogeneous() - Vector3d(around_mm * angle / (2 * std::numbers::pi), 23, height))
              .norm(),
          1e-2);
      const Eigen::Matrix3d frame = frame_at(shell, *cell, at);
      EXPECT_LT((frame.col(2) - normal).norm(), 2e-4);
      EXPECT_LT((frame.col(0) - along).norm(), 2e-4);
      EXPECT_LT((frame.col(1) - Vector3d::UnitZ()).norm(), 1e-9);
      EXPECT_LT((world_from_patch(*cell) * (cell->patch_from_world * at.homogeneous()).homogeneous() - at).norm(),
                1e-9);
    }
  }
}

// Every place in the shell that a line passes belongs to the line's span in some cell, round the seam as well.
TEST(ClothShellTest, CellsLeaveNoGaps) {
  const ClothShell shell = shell_of(CylinderShape{5, 20});
  std::mt19937 random(5);
  std::normal_distribution<double> n;
  int places = 0;
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.02 * n(random);  // near the seam
    const Vector3d through = 5.0 * Vector3d(std::cos(angle), std::sin(angle), 0) + Vector3d(0, 0, 10 + n(random));
    const Vector3d direction = Vector3d(0.1 * n(random), n(random), n(random)).normalized();
    std::vector<RaySpan> spans;
    for (const ShellCell& cell : shell.cells)
      if (const auto span = clip(cell, through, direction, {-3, 3})) spans.push_back(*span);
    for (double t = -3; t < 3; t += 0.01) {
      const Vector3d at = through + t * direction;
      const double height = std::hypot(at.x(), at.y()) - 5;
      if (height < -0.399 || height > 0.599) continue;  // the faces lie up to 0.4 um inside the cylinder
      ++places;
      const auto holds = [&](const RaySpan& span) { return span.begin <= t && t <= span.end; };
      ASSERT_TRUE(std::any_of(spans.begin(), spans.end(), holds)) << at.transpose();
    }
  }
  EXPECT_GT(places, 10000);
}

// Cells that share a point of a face send it to the same place of the patch, but for whole turns round the cylinder.
TEST(ClothShellTest, TheMapHasNoJumps) {
  const ClothShell shell = shell_of(CylinderShape{5, 60});  // of several rows of triangles
  const double around_mm = 2 * std::round(std::numbers::pi * 5);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> u(0.01, 1);
  int shared = 0;
  for (std::size_t i = 0; i < shell.cells.size(); i += 5) {
    const ShellCell& cell = shell.cells[i];
    ASSERT_EQ(cell.faces, 4);
    for (int face = 0; face < 4; ++face) {
      Eigen::Vector4d weights(u(random), u(random), u(random), u(random));
      weights[face] = 0;
      weights /= weights.sum();
      const Vector3d at = (cell.inside_from_world.topRows<4>().inverse() * weights).head<3>();
      const Vector3d place = cell.patch_from_world * at.homogeneous();
      for (const ShellCell& other : shell.cells) {
        if (&other == &cell || (other.inside_from_world * at.homogeneous()).head<4>().minCoeff() < -1e-9) continue;
        ++shared;
        Vector3d jump = other.patch_from_world * at.homogeneous() - place;
        jump.x() = std::remainder(jump.x(), around_mm);
        EXPECT_LT(jump.norm(), 1e-6);
      }
    }
  }
  EXPECT_GT(shared, 1000);
}

TEST(ClothShellTest, ASpanLiesWithinTheAskedPart) {
  const ClothShell shell = shell_of(SwatchShape{4, 4});
  int found = 0;
  for (const ShellCell& cell : shell.cells)
    if (const auto span = clip(cell, {0.3, 0.2, 5}, -Vector3d::UnitZ(), {4.9, 5.2})) {
      ++found;
      EXPECT_GE(span->begin, 4.9);
      EXPECT_LE(span->end, 5.2);
    }
  EXPECT_GE(found, 1);
}

TEST(ClothShellTest, SurfacesThatAreNoneAreRefused) {
  const ClothSurface good = surface_of(SwatchShape{4, 4}, empty_patch(), Isometry3d::Identity());
  const auto refused = [](ClothSurface surface, const std::string& because) {
    try {
      make_shell(surface, kHeights);
      ADD_FAILURE() << because;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(because), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  };
  ClothSurface bad = good;
  bad.normals.pop_back();
  refused(bad, "normals");
  bad = good;
  bad.triangles[0][1] = 99;
  refused(bad, "triangle 0 names vertex 99");
  bad = good;
  bad.patch_mm[1] = bad.patch_mm[0];
  refused(bad, "no area in the patch");
  bad = good;
  for (auto& place : bad.patch_mm) place.x() *= -1;
  refused(bad, "wrong way round");
  refused(surface_of(CylinderShape{0.35, 4}, empty_patch(), Isometry3d::Identity()), "bends more sharply");
  EXPECT_THROW(surface_of(CylinderShape{0.1, 4}, empty_patch(), Isometry3d::Identity()), std::runtime_error);
}

}  // namespace
}  // namespace renderer
