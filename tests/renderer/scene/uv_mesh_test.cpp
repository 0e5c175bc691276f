#include "renderer/scene/uv_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "renderer/scattering/degree.h"
#include "renderer/trace/cloth_shell.h"

namespace renderer {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Adds columns of a tube of radius 5 about z, from z = 0 to 8, between two angles; uv is in degrees and tenths of mm.
// Vertices are numbered from below or, if `downwards`, from above. The columns twist by `twist_deg` a row.
void add_panel(UvMesh& mesh, int from_deg, int to_deg, bool downwards, bool mirrored, int twist_deg) {
  constexpr int kStep_deg = 5, kRows = 4;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const int columns = (to_deg - from_deg) / kStep_deg;
  for (int numbered = 0; numbered <= kRows; ++numbered)
    for (int column = 0; column <= columns; ++column) {
      const int row = downwards ? kRows - numbered : numbered;
      const int deg = (from_deg + column * kStep_deg) % 360;  // the last is exactly the first again
      const double angle = (deg + twist_deg * row) * kDegree;
      mesh.vertices.emplace_back(5 * std::cos(angle), 5 * std::sin(angle), 2.0 * row);
      mesh.uv.emplace_back((mirrored ? -1.0 : 1.0) * kStep_deg * column, 20.0 * row);
    }
  const auto index = [&](int column, int row) {
    return first + static_cast<std::uint32_t>((downwards ? kRows - row : row) * (columns + 1) + column);
  };
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < columns; ++column) {
      mesh.triangles.push_back({index(column, row), index(column + 1, row), index(column + 1, row + 1)});
      mesh.triangles.push_back({index(column, row), index(column + 1, row + 1), index(column, row + 1)});
    }
}

UvMesh two_panels(bool one_mirrored = false, int twist_deg = 0) {
  UvMesh mesh;
  add_panel(mesh, 0, 180, false, false, twist_deg);
  add_panel(mesh, 180, 360, true, one_mirrored, twist_deg);
  return mesh;
}

std::string refusal(const UvMesh& mesh) {
  try {
    cloth_surface(mesh, {}, Isometry3d::Identity(), "it.obj");
  } catch (const std::runtime_error& problem) {
    return problem.what();
  }
  return {};
}

TEST(UvMeshTest, TheSameAreaOfClothAsOfMeshUnlessAskedOtherwise) {
  const UvMesh mesh = two_panels();
  const auto area_of = [&](const UvPlacement& placement) {
    const ClothSurface surface = cloth_surface(mesh, placement, Isometry3d::Identity(), "tube");
    double in_patch = 0, in_world = 0;
    for (const auto& t : surface.triangles) {
      const Vector2d a = surface.patch_mm[t[1]] - surface.patch_mm[t[0]],
                     b = surface.patch_mm[t[2]] - surface.patch_mm[t[0]];
      in_patch += (a.x() * b.y() - a.y() * b.x()) / 2;
      in_world += (surface.vertices[t[1]] - surface.vertices[t[0]])
                      .cross(surface.vertices[t[2]] - surface.vertices[t[0]])
                      .norm() /
                  2;
    }
    return std::pair(in_patch, in_world);
  };
  const auto [patch, world] = area_of({.unit_mm = 10});
  EXPECT_NEAR(patch / world, 1, 1e-12);
  EXPECT_NEAR(world, 100 * 2 * std::numbers::pi * 5 * 8, 0.01 * world);  // a tube of 72 facets
  EXPECT_NEAR(area_of({.unit_mm = 1, .uv_mm = 0.5}).first, 360 * 80 * 0.25, 1e-6);
}

TEST(UvMeshTest, TheWeaveTurnsInThePattern) {
  const UvMesh mesh = two_panels();
  const ClothSurface straight = cloth_surface(mesh, {.uv_mm = 1}, Isometry3d::Identity(), "tube");
  const ClothSurface turned =
      cloth_surface(mesh, {.uv_mm = 1, .turn_rad = std::numbers::pi / 2}, Isometry3d::Identity(), "tube");
  // What lies to the right in the pattern lies below in a weave that is turned counter-clockwise.
  EXPECT_NEAR((straight.patch_mm[1] - Vector2d(5, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((turned.patch_mm[1] - Vector2d(0, -5)).norm(), 0, 1e-12);
}

TEST(UvMeshTest, NormalsAreSmoothAcrossSeams) {
  const Isometry3d pose(Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()));
  const UvMesh mesh = two_panels();
  const ClothSurface surface = cloth_surface(mesh, {}, pose, "tube");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3d outwards = Vector3d(mesh.vertices[i].x(), mesh.vertices[i].y(), 0).normalized();
    EXPECT_LT((surface.normals[i] - pose.linear() * outwards).norm(), 0.03) << i;  // half a facet at the borders
  }
}

// The law of ClothShellTest.CellsLeaveNoGaps, at the seams of two panels whose vertices are numbered in opposite ways.
// The seams wind round the tube, because along a straight one the shell's faces are flat and any diagonal would do.
TEST(UvMeshTest, ClothGoesThroughASeamWithoutAGap) {
  const ClothSurface surface = cloth_surface(two_panels(false, 15), {}, Isometry3d::Identity(), "tube");
  const ClothShell shell = make_shell(surface, {-0.4, 0.6});
  std::mt19937 random(5);
  std::normal_distribution<double> n;
  int places = 0;
  for (int i = 0; i < 400; ++i) {
    const double z = 4 + n(random), angle = (i % 2 ? std::numbers::pi : 0) + 15 * kDegree * z / 2 + 0.01 * n(random);
    const Vector3d through(5 * std::cos(angle), 5 * std::sin(angle), z);
    const Vector3d direction = Vector3d(0.1 * n(random), n(random), n(random)).normalized();
    std::vector<RaySpan> spans;
    for (const ShellCell& cell : shell.cells)
      if (const auto span = clip(cell, through, direction, {-3.1, 3.1})) spans.push_back(*span);
    for (double t = -3; t < 3; t += 0.003) {
      const Vector3d at = through + t * direction;
      const double height = std::hypot(at.x(), at.y()) - 5;
      if (height < -0.3 || height > 0.4 || at.z() < 1 || at.z() > 7) continue;  // facets cut off up to 0.1
      ++places;
      // The spans overlap by kShellOverlap, which would hide small gaps.
      const auto holds = [&](const RaySpan& span) {
        return span.begin + kShellOverlap <= t + 1e-6 && t - 1e-6 <= span.end - kShellOverlap;
      };
      ASSERT_TRUE(std::any_of(spans.begin(), spans.end(), holds)) << at.transpose();
    }
  }
  EXPECT_GT(places, 50000);
}

TEST(UvMeshTest, MirroredPiecesShowTheirFace) {
  const ClothSurface surface = cloth_surface(two_panels(true), {}, Isometry3d::Identity(), "tube");
  EXPECT_NO_THROW(make_shell(surface, {-0.4, 0.6}));
}

TEST(UvMeshTest, MeshesThatCannotBeClothAreRefusedInOneLine) {
  UvMesh no_uv = two_panels();
  no_uv.uv.clear();
  EXPECT_EQ(refusal(no_uv),
            "it.obj: has no uv coordinates, which say where each place of the cloth was cut from; unwrap the mesh");
  UvMesh flat = two_panels();
  flat.triangles.push_back({0, 1, 1});
  EXPECT_EQ(refusal(flat), "it.obj: 1 of 577 triangles have no area; remove them from the mesh");
  UvMesh pointlike = two_panels();
  pointlike.uv[0] = pointlike.uv[1];
  EXPECT_EQ(refusal(pointlike),
            "it.obj: 1 of 576 triangles have no area in uv; unwrap the mesh so that each has its place");
  UvMesh folded = two_panels();
  folded.uv[0].x() = 20;
  EXPECT_NE(refusal(folded).find("lie upside down in uv; unwrap the mesh without folds"), std::string::npos)
      << refusal(folded);
}

}  // namespace
}  // namespace renderer
