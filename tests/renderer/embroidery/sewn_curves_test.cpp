#include "renderer/embroidery/sewn_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "renderer/scene/cloth_shape.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A line of points along x, `height` above the cloth.
std::vector<CurveSet> line(double from_mm, double to_mm, float height_mm) {
  CurveSet set;
  std::vector<Eigen::Vector4f> points;
  for (int i = 0; i <= 20; ++i)
    points.push_back({static_cast<float>(from_mm + (to_mm - from_mm) * i / 20), 0, height_mm, 0.2F});
  set.add_clamped_curve(points);
  return {set};
}

TEST(SewnCurves, OnAFlatClothTheyAreMovedTurnedAndRaised) {
  const ClothSurface flat = surface_of(SwatchShape{40, 30}, plain_patch(), Eigen::Isometry3d::Identity());
  EXPECT_LT((middle_of(flat) - Vector2d(20, 15)).norm(), 1e-9);
  const MotifPlace place{.at_mm = {20, 15}, .turn_rad = std::numbers::pi / 2};
  const CurveSet sewn = sewn_curves(line(-5, 5, 0.3F), place, flat, 0.5).front();
  for (std::size_t i = 0; i < sewn.control_points.size(); ++i) {
    // The patch begins at the swatch's lower left corner, and its middle is the world's origin.
    const double along = -5 + 0.5 * (static_cast<double>(i) - 1);
    EXPECT_LT((sewn.control_points[i].head<3>() - Eigen::Vector3f(0, static_cast<float>(along), 0.8F)).norm(), 1e-4F);
    EXPECT_EQ(sewn.control_points[i].w(), 0.2F);
  }
}

TEST(SewnCurves, RoundACylinderTheyLieAboveItAndKeepTheirLength) {
  const CylinderShape tube{41, 100};
  const ClothSurface surface = surface_of(tube, plain_patch(), Eigen::Isometry3d::Identity());
  const CurveSet sewn = sewn_curves(line(-20, 20, 0), {.at_mm = middle_of(surface)}, surface, 1).front();
  double length = 0;
  for (std::size_t i = 1; i + 2 < sewn.control_points.size(); ++i) {
    const Eigen::Vector4f &a = sewn.control_points[i], &b = sewn.control_points[i + 1];
    EXPECT_NEAR(std::hypot(a.x(), a.y()), 42, 0.05) << "of the tube's facets";
    length += static_cast<double>((b - a).head<3>().norm());
  }
  EXPECT_NEAR(length, 40 * 42.0 / 41, 0.3);
}

TEST(SewnCurves, BesideTheClothIsOneLine) {
  const ClothSurface flat = surface_of(SwatchShape{40, 30}, plain_patch(), Eigen::Isometry3d::Identity());
  try {
    sewn_curves(line(-25, 25, 0), {.at_mm = middle_of(flat)}, flat, 0);
    FAIL();
  } catch (const std::runtime_error& refused) {
    const std::string message = refused.what();
    EXPECT_NE(message.find("beside it"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace renderer
