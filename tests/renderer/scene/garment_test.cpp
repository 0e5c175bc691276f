#include "renderer/scene/garment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <string>

#include "renderer/scene/hem.h"
#include "renderer/scene/studio.h"
#include "renderer/trace/cloth_shell.h"
#include "tests/renderer/scene/self_crossings.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

// By how much the edges of the mesh are longer than in the pattern: mean of the square's root, and the largest.
std::pair<double, double> stretch_of(const UvMesh& mesh) {
  double sum2 = 0, most = 0;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const double off = (mesh.vertices[a] - mesh.vertices[b]).norm() / (mesh.uv[a] - mesh.uv[b]).norm() - 1;
      sum2 += off * off;
      most = std::max(most, std::abs(off));
    }
  return {std::sqrt(sum2 / (3.0 * static_cast<double>(mesh.triangles.size()))), most};
}

const GarmentShape kReady[] = {SkirtShape{}, PleatedShape{}, DrapeShape{}, SariShape{}};
const std::span kSoonMade(kReady, 3);  // the sari takes as long as all others

// Made once.
const UvMesh& ready_mesh(const GarmentShape& shape) {
  static const UvMesh meshes[] = {garment_mesh(kReady[0]), garment_mesh(kReady[1]), garment_mesh(kReady[2]),
                                  garment_mesh(kReady[3])};
  return meshes[shape.index()];
}

TEST(GarmentTest, HangingClothHardlyStretches) {
  for (const GarmentShape& shape : kReady) {
    const auto [typical, most] = stretch_of(ready_mesh(shape));
    std::printf("garment %zu: edges off by %.4f, at most %.3f\n", shape.index(), typical, most);
    // Shear lets diagonals of the drape give way where cloth of a square lies on a ball.
    EXPECT_LT(typical, 0.08) << shape.index();
  }
}

TEST(GarmentTest, TheReadyOnesAreSurfacesForCloth) {
  for (const GarmentShape& shape : kReady) {
    const UvMesh& mesh = ready_mesh(shape);
    const ClothSurface surface = cloth_surface(mesh, {.uv_mm = 1}, Eigen::Isometry3d::Identity(), "garment");
    const double reach_mm = std::holds_alternative<SariShape>(shape) ? 0.5 : 0.8;  // a sari is of fine cloth
    EXPECT_NO_THROW(make_shell(surface, {-reach_mm, reach_mm})) << shape.index();
    double lowest = mesh.vertices.front().z();
    for (const Vector3d& vertex : mesh.vertices) lowest = std::min(lowest, vertex.z());
    EXPECT_NEAR(lowest, 0, 1e-9) << shape.index();
  }
}

TEST(GarmentTest, AnyOneIsASurfaceForCloth) {
  constexpr unsigned kGarmentSeed = 20261130;
  std::printf("seed %u\n", kGarmentSeed);
  std::mt19937 random(kGarmentSeed);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  for (int i = 0; i < 3; ++i) {
    const SkirtShape skirt{.waist_radius_mm = between(60, 160),
                           .length_mm = between(250, 900),
                           .flare_deg = between(90, 360),
                           .folds = static_cast<int>(between(5, 20))};
    const PleatedShape pleats{.width_mm = between(400, 1500),
                              .height_mm = between(500, 1600),
                              .pleats = static_cast<int>(between(4, 14)),
                              .gathered = between(0.4, 0.85)};
    for (const GarmentShape& shape : {GarmentShape(skirt), GarmentShape(pleats)}) {
      const UvMesh mesh = garment_mesh(shape);
      const std::string which =
          shape.index() == 0
              ? "skirt " + std::to_string(skirt.waist_radius_mm) + " " + std::to_string(skirt.length_mm) + " " +
                    std::to_string(skirt.flare_deg) + " " + std::to_string(skirt.folds)
              : "pleats " + std::to_string(pleats.width_mm) + " " + std::to_string(pleats.height_mm) + " " +
                    std::to_string(pleats.pleats) + " " + std::to_string(pleats.gathered);
      const ClothSurface surface = cloth_surface(mesh, {.uv_mm = 1}, Eigen::Isometry3d::Identity(), "garment");
      EXPECT_NO_THROW(make_shell(surface, {-0.5, 0.5})) << which;
      EXPECT_LT(stretch_of(mesh).first, 0.08) << which;
      EXPECT_EQ(self_crossings(mesh), 0) << which;
    }
  }
}

TEST(GarmentTest, NoClothPassesThroughItself) {
  // Two sheets of two triangles each that pass through one another: what the count is worth.
  const UvMesh crossed{
      .vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}, {0.3, 1.2, -1}, {1.7, 1.1, -1}, {0.9, 1.3, 1}},
      .triangles = {{0, 1, 2}, {1, 3, 2}, {4, 5, 6}}};
  EXPECT_GT(self_crossings(crossed), 0);
  for (const GarmentShape& shape : kReady) EXPECT_EQ(self_crossings(ready_mesh(shape)), 0) << shape.index();
}

// Cloth turned up behind the lower edge, as much longer in the pattern, that leaves room for what is in front of it.
TEST(GarmentTest, AHemIsTurnedUpBehindTheEdge) {
  for (const double hem_mm : {10.0, 40.0}) {
    const PleatedShape shape{.hem_mm = hem_mm};
    PleatedShape cut = shape;
    cut.hem_mm = 0;
    const UvMesh mesh = garment_mesh(shape), without = garment_mesh(cut);
    const std::size_t more = mesh.vertices.size() - without.vertices.size();
    double lowest_uv = 0, least_mm = 1e9, highest_mm = 0;
    for (std::size_t i = 0; i < more; ++i) {
      lowest_uv = std::min(lowest_uv, mesh.uv[i].y());
      highest_mm = std::max(highest_mm, mesh.vertices[i].z());
    }
    EXPECT_NEAR(-lowest_uv, hem_mm + std::numbers::pi * kHemFold_mm, 0.1 * hem_mm + 5);
    EXPECT_GT(highest_mm, 0.8 * hem_mm);
    // Its first row, furthest up, from all cloth in front.
    const std::size_t across = 601;
    const ClothSurface surface = cloth_surface(mesh, {.uv_mm = 1}, Eigen::Isometry3d::Identity(), "hem");
    for (std::size_t i = 0; i < across; ++i) {
      std::size_t nearest = more;
      for (std::size_t k = more; k < mesh.vertices.size(); ++k)
        if ((mesh.vertices[k] - mesh.vertices[i]).squaredNorm() <
            (mesh.vertices[nearest] - mesh.vertices[i]).squaredNorm())
          nearest = k;
      const Vector3d behind = mesh.vertices[i] - mesh.vertices[nearest];
      least_mm = std::min(least_mm, behind.norm());
      ASSERT_LT(behind.dot(surface.normals[nearest]), 0) << "the face of the cloth is in front";
    }
    EXPECT_GT(least_mm, 1.9 * kHemFold_mm);
    EXPECT_LT(least_mm, 2.1 * kHemFold_mm);
  }
  EXPECT_TRUE(hem_of({{{0, 0, 0}, {1, 0, 0}, {0, 0, -1}, {1, 0, -1}}, 2, 2}, 0).places.empty());
}

TEST(GarmentTest, ASkirtShowsItsFaceOutside) {
  const UvMesh& mesh = ready_mesh(SkirtShape{});
  const ClothSurface surface = cloth_surface(mesh, {.uv_mm = 1}, Eigen::Isometry3d::Identity(), "skirt");
  double outwards = 0;
  for (std::size_t i = 0; i < surface.vertices.size(); ++i)
    outwards += Vector3d(surface.vertices[i].x(), surface.vertices[i].y(), 0).normalized().dot(surface.normals[i]);
  EXPECT_GT(outwards / static_cast<double>(surface.vertices.size()), 0.3);
}

TEST(GarmentTest, TheDrapeLiesOnTheBallAndHangsBelowIt) {
  const DrapeShape shape;
  const UvMesh& mesh = ready_mesh(shape);
  double top = 0;
  for (const Vector3d& vertex : mesh.vertices) top = std::max(top, vertex.z());
  const Vector3d ball(0, 0, top - shape.ball_radius_mm);
  double nearest = 1e9;
  int lying = 0;
  for (const Vector3d& vertex : mesh.vertices) {
    const double distance = (vertex - ball).norm();
    nearest = std::min(nearest, distance);
    lying += distance < 1.02 * shape.ball_radius_mm;
  }
  EXPECT_GT(nearest, 0.98 * shape.ball_radius_mm);
  EXPECT_GT(lying, 1000);
  EXPECT_GT(top, 1.5 * shape.ball_radius_mm);
}

// Over the shoulder at most a little lower than it, and on both sides of it down to hems that are as long as asked.
TEST(GarmentTest, ASariHangsOnBothSidesOfTheShoulderInOrderlyPleats) {
  const SariShape shape;
  const UvMesh& mesh = ready_mesh(shape);
  double top = 0;
  std::array<double, 2> lowest{1e9, 1e9};  // in front, behind
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    double& of_part = lowest[mesh.uv[i].y() < shape.front_mm ? 0 : 1];
    of_part = std::min(of_part, mesh.vertices[i].z());
    top = std::max(top, mesh.vertices[i].z());
  }
  // An arc of the shoulder is not below it.
  EXPECT_NEAR(top - lowest[0], shape.front_mm, 0.06 * shape.front_mm);
  EXPECT_NEAR(top - lowest[1], shape.length_mm - shape.front_mm, 0.06 * shape.front_mm);
  // In front the face is seen: no pleat lies with its back outwards, but for the hem behind its end.
  int turned = 0, all = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    if (mesh.uv[t[0]].y() > shape.front_mm || mesh.uv[t[0]].y() < 0 || mesh.uv[t[2]].y() < 0 ||
        a.z() > top - 3 * shape.shoulder_radius_mm)
      continue;
    ++all, turned += (b - a).cross(c - a).y() > 0 ? 1 : 0;
  }
  EXPECT_GT(all, 100000);
  EXPECT_LT(turned, 0.005 * all);
}

TEST(GarmentTest, TheWorkTellsHowFarItIsAndStopsWhenAsked) {
  for (const GarmentShape& shape : kSoonMade) {
    double last = -1;
    int calls = 0;
    const auto until_half = [&](double finished) {
      EXPECT_GE(finished, last);
      EXPECT_LT(finished, 1);
      ++calls;
      return (last = finished) < 0.5;
    };
    EXPECT_THROW(garment_mesh(shape, until_half), std::runtime_error) << shape.index();
    EXPECT_NEAR(last, 0.5, 0.02) << shape.index();
    EXPECT_GT(calls, 75) << shape.index();  // often enough for a person who waits
  }
}

TEST(GarmentTest, ASariThatDoesNotHangOnBothSidesIsRefused) {
  try {
    garment_mesh(SariShape{.length_mm = 2000, .front_mm = 1900});
    ADD_FAILURE() << "was made";
  } catch (const std::runtime_error& problem) {
    EXPECT_NE(std::string(problem.what()).find("give front_mm more than 314"), std::string::npos) << problem.what();
  }
}

TEST(GarmentTest, TheSameShapeGivesTheSameMesh) {
  for (const GarmentShape& shape : kSoonMade) EXPECT_EQ(garment_mesh(shape).vertices, ready_mesh(shape).vertices);
}

// All of it is seen from where cameras and lamps are, and no step of the bend is more than a degree.
TEST(BackdropTest, ShowsItsBrightSideInsideWithoutAnEdge) {
  const BackdropShape shape{.radius_mm = 2000, .height_mm = 1500, .bend_mm = 800};
  const UvMesh mesh = backdrop_mesh(shape);
  const TriangleMesh made = body(mesh, 1, Eigen::Isometry3d::Identity(), {1, 1, 1});
  const Vector3d inside(300, -200, 400);
  double area = 0;
  int turned_away = 0, flat = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vector3d normal = (b - a).cross(c - a);
    flat += normal.norm() > 0 ? 0 : 1;
    turned_away += normal.dot(inside - a) > 0 ? 0 : 1;
    area += normal.norm() / 2;
  }
  EXPECT_EQ(flat, 0);
  EXPECT_EQ(turned_away, 0);
  EXPECT_EQ(made.triangles.size(), mesh.triangles.size());
  // Disc, quarter of a torus from outside of its hole, tube.
  const double pi = std::numbers::pi, r = 2000 - 800, b = 800;
  const double bend = 2 * pi * b * (r * pi / 2 + b);
  EXPECT_NEAR(area / (pi * r * r + bend + 2 * pi * 2000 * (1500 - b)), 1, 1e-3);
  EXPECT_THROW(backdrop_mesh({.radius_mm = 100, .height_mm = 500, .bend_mm = 200}), std::runtime_error);
}

// No light comes down past it, and the cloth hangs free of it.
TEST(FormTest, ClosesTheWaistOfAReadySkirt) {
  const UvMesh form = form_mesh({}), &skirt = ready_mesh(SkirtShape{});
  double top = 0, waist = 0, least_waist = 1e9;
  for (const Vector3d& at : form.vertices) {
    top = std::max(top, at.z());
    EXPECT_LE(at.head<2>().norm(), FormShape{}.radius_mm + 1e-9);
  }
  for (const Vector3d& at : skirt.vertices) waist = std::max(waist, at.z());
  for (const Vector3d& at : skirt.vertices) {
    if (at.z() > waist - 1) least_waist = std::min(least_waist, at.head<2>().norm());
    if (at.z() < top) EXPECT_GT(at.head<2>().norm(), FormShape{}.radius_mm + 5);
  }
  std::printf("the form ends %.1f mm below the waist, which is %.1f mm wide at least\n", waist - top, 2 * least_waist);
  EXPECT_GT(waist, top);
  EXPECT_LT(waist, top + 40);
  for (const auto& t : form.triangles) {
    const Vector3d &a = form.vertices[t[0]], &b = form.vertices[t[1]], &c = form.vertices[t[2]];
    ASSERT_GT((b - a).cross(c - a).dot(a - Vector3d(0, 0, 200)), 0) << "its face is outside";
  }
}

}  // namespace
}  // namespace renderer
