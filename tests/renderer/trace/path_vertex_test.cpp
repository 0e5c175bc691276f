#include "renderer/trace/path_vertex.h"

#include <gtest/gtest.h>

#include <cmath>

namespace renderer {
namespace {

using Eigen::Vector3f;

constexpr float kRadius = 0.25f;
// A thread along z, met at its side +x.
const CurvePoint kEntry{
    .curve_set = 0, .position = {3 + kRadius, 4, 5}, .tangent = {0, 0, 1}, .normal = {1, 0, 0}, .radius = kRadius};
const Vector3f kAxis(3, 4, 5);

TEST(FarSidePositionTest, WhatComesBackLeavesWhereItCameIn) {
  for (const Vector3f& wi : {Vector3f(1, 0, 0), Vector3f(0.6f, 0.8f, 0), Vector3f(0.01f, 0, 0.99995f)})
    EXPECT_EQ(far_side_position(kEntry, wi, 0.3f), kEntry.position);
}

TEST(FarSidePositionTest, WhatGoesOnLeavesAnywhereAcrossTheWidthThatItsDirectionSees) {
  for (const Vector3f& wi : {Vector3f(-1, 0, 0), Vector3f(-0.6f, 0.8f, 0), Vector3f(-0.48f, -0.36f, 0.8f)}) {
    const Vector3f outward = Vector3f(wi.x(), wi.y(), 0).normalized();
    const Vector3f across = kEntry.tangent.cross(outward);
    for (float u : {0.0f, 0.1f, 0.5f, 0.9f, 0.999f}) {
      const Vector3f from_axis = far_side_position(kEntry, wi, u) - kAxis;
      EXPECT_NEAR(from_axis.norm(), kRadius, 1e-6);
      EXPECT_NEAR(from_axis.z(), 0, 1e-6);                            // the cross-section of the entry
      EXPECT_GE(from_axis.dot(outward), -1e-6);                       // the side that faces the direction
      EXPECT_NEAR(from_axis.dot(across) / kRadius, 2 * u - 1, 1e-5);  // evenly across the width
    }
  }
}

TEST(FarSidePositionTest, AlongTheThreadItLeavesWhereItCameIn) {
  EXPECT_EQ(far_side_position(kEntry, kEntry.tangent, 0.3f), kEntry.position);
}

TEST(FarSidePositionTest, IsForThreadsOnlyAndCanBeSwitchedOff) {
  ThreadParameters thread, entry;
  entry.exit = ThreadExit::entry_point;
  const auto models =
      prepare_curve_models(std::vector<ScatteringModel>{thread, entry, FiberParameters{}, YarnParameters{}});
  EXPECT_TRUE(leaves_on_far_side(models[0]));
  for (std::size_t i : {1u, 2u, 3u}) EXPECT_FALSE(leaves_on_far_side(models[i]));
}

}  // namespace
}  // namespace renderer
