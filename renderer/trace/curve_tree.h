// Curves in a tree of boxes, eight to a node, with up to eight pieces of curves in each leaf: what rays meet of a
// scene's explicit curves.
//
// It finds the surfaces that Embree calls round B-spline curves, to 0.0002 radii where Embree finds them to 0.002, and
// about 1.5 times as quickly (tests/bench/bench_yarn_grid.cpp). Embree's builder lays it out. Curves are met from
// outside only (ray_scene.h).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "renderer/scene/scene.h"
#include "renderer/trace/curve_tree_kernel.h"
#include "renderer/trace/ray_hit.h"

struct RTCDeviceTy;

namespace renderer {

class CurveTree {
 public:
  struct Hit {
    std::uint32_t set, segment;  // number of the curve set, and of its segment
    float u;                     // parameter on the segment
    float distance;              // mm, along the ray
    Eigen::Vector3f normal;      // outwards in the curves' frame, not unit
  };

  // Of those of the sets whose numbers are given; they lie in the same frame and are cut by the same planes. Embree's
  // `device` lays the tree out. Errors: std::runtime_error for a control point that is no number, and when there is no
  // memory for the tree.
  CurveTree(RTCDeviceTy* device, const std::vector<CurveSet>& curves, const std::vector<std::uint32_t>& sets);

  // The first place within `distance` where the ray (world) enters a curve.
  std::optional<Hit> nearest(const Ray& ray, float distance) const;
  bool occluded(const Ray& ray, float distance) const;

  const Eigen::AlignedBox3f& bounds() const { return bounds_; }  // world
  std::size_t bytes() const;

 private:
  CurveTreeData data() const;
  // The ray in the curves' frame, and how much longer distances are there.
  std::pair<CurveTreeRay, float> local(const Ray& ray, float distance) const;

  const CurveTreeKernel* kernel_;
  std::optional<Eigen::Affine3f> from_world_;  // none: the curves' frame is the world
  std::vector<CurveTreeNode> nodes_;
  std::vector<CurvePieces> pieces_;
  std::vector<CurveSegment> segments_;
  std::vector<std::array<float, 4>> cuts_;
  struct SetBegin {
    std::uint32_t set, first;  // number of its first segment in segments_
  };
  std::vector<SetBegin> sets_;
  Eigen::AlignedBox3f bounds_;
};

// The trees of all curves: one for each placement and cut that occur.
std::vector<CurveTree> curve_trees(RTCDeviceTy* device, const std::vector<CurveSet>& curves);

}  // namespace renderer
