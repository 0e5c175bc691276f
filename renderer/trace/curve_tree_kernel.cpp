// The intersection of rays with the tree of curve_tree.h: the boxes of a node are tested all at a time, and what is
// inside the nearest is looked at first.
#include "renderer/trace/curve_tree_kernel.h"

#include "renderer/trace/piece_solver.h"

namespace renderer::KERNEL_NAMESPACE {
namespace {

// Deeper trees are not built (curve_tree.cpp).
constexpr int kMostWaiting = (kTreeWidth - 1) * kMostTreeDepth + 1;

struct Waiting {
  float near;
  std::int32_t child;
};

// A ray as boxes are asked for it.
struct BoxRay {
  Float8 origin[3], inverse[3];
  int near[3];  // rows of CurveTreeNode::bounds that the ray meets first
};

INLINE BoxRay box_ray(const CurveTreeRay& ray) {
  BoxRay r;
  for (int i = 0; i < 3; ++i) {
    const float d = ray.direction[i];
    const bool tiny = d < 1 / kFar && d > -1 / kFar;
    r.origin[i] = ray.origin[i] + Float8{};
    r.inverse[i] = (tiny ? kFar : 1 / d) + Float8{};
    r.near[i] = d < 0 && !tiny ? i + 3 : i;
  }
  return r;
}

// The boxes that the ray meets before `most`, as bits, and where.
INLINE unsigned meet_boxes(const CurveTreeNode& node, const BoxRay& ray, float most, Float8& near) {
  near = Float8{};
  Float8 far = most + Float8{};
  for (int i = 0; i < 3; ++i) {
    const int begins = ray.near[i], ends = begins < 3 ? begins + 3 : begins - 3;
    near = max8(near, (load8(node.bounds[begins]) - ray.origin[i]) * ray.inverse[i]);
    far = min8(far, (load8(node.bounds[ends]) - ray.origin[i]) * ray.inverse[i]);
  }
  return bits8(near <= far * 1.000001f);
}

INLINE bool is_cut_off(const CurveTreeData& tree, const CurveTreeRay& ray, float t) {
  for (int i = 0; i < tree.cut_count; ++i) {
    float beyond = -tree.cuts[i][3];
    for (int k = 0; k < 3; ++k) beyond += tree.cuts[i][k] * (ray.origin[k] + t * ray.direction[k]);
    if (beyond > 0) return true;
  }
  return false;
}

// The nearest hit before `best`, or with `any` the first that is found. The pieces' box is entered at `begin`: from
// there they are looked for, because what is far away is rounded.
template <bool any>
INLINE bool meet_pieces(const CurveTreeData& tree, const CurvePieces& pieces, const CurveTreeRay& ray, LocalRay local,
                        float begin, float& best, CurveTreeHit* hit) {
  const Stretch none{};
  local.origin += begin * local.direction;
  Approach approach;
  bool found = false;
  for (unsigned bits = candidates<false>(pieces, local, none, best - begin, approach); bits; bits &= bits - 1) {
    const int lane = __builtin_ctz(bits);
    Solution solution;
    if (approach.near[lane] > best - begin ||
        !solve<false>(tree.segments, pieces, lane, approach, local, none, best - begin, solution) ||
        is_cut_off(tree, ray, begin + solution.t))
      continue;
    if (any) return true;
    found = true;
    best = begin + solution.t;
    hit->segment = pieces.segment[lane];
    hit->u = solution.u;
    hit->distance = best;
    for (int k = 0; k < 3; ++k) hit->normal[k] = solution.normal[k];
  }
  return found;
}

template <bool any>
INLINE bool walk_tree(const CurveTreeData& tree, const CurveTreeRay& ray, CurveTreeHit* hit) {
  const BoxRay boxes = box_ray(ray);
  const LocalRay local{{ray.origin[0], ray.origin[1], ray.origin[2], 0},
                       {ray.direction[0], ray.direction[1], ray.direction[2], 0}};
  Waiting waiting[kMostWaiting];
  int count = 0;
  float best = ray.length, begin = 0;
  bool found = false;
  for (std::int32_t at = 0;;) {
    if (at >= 0) {
      const CurveTreeNode& node = tree.nodes[at];
      Float8 near;
      unsigned bits = meet_boxes(node, boxes, best, near);
      // Those that are met go on the stack, the nearest last.
      const int before = count;
      for (; bits; bits &= bits - 1) {
        const int lane = __builtin_ctz(bits);
        const float where = near[lane];
        int place = count++;
        if (!any)
          for (; place > before && waiting[place - 1].near < where; --place) waiting[place] = waiting[place - 1];
        waiting[place] = {where, node.child[lane]};
      }
    } else if (meet_pieces<any>(tree, tree.pieces[-1 - at], ray, local, begin, best, hit)) {
      if (any) return true;
      found = true;
    }
    do {
      if (count == 0) return found;
      --count;
    } while (waiting[count].near > best);
    at = waiting[count].child, begin = waiting[count].near;
  }
}

bool nearest_in_tree(const CurveTreeData& tree, const CurveTreeRay& ray, CurveTreeHit& hit) {
  return walk_tree<false>(tree, ray, &hit);
}

bool occluded_in_tree(const CurveTreeData& tree, const CurveTreeRay& ray) {
  return walk_tree<true>(tree, ray, nullptr);
}

}  // namespace

extern const CurveTreeKernel kCurveTreeKernel;
const CurveTreeKernel kCurveTreeKernel{nearest_in_tree, occluded_in_tree};

}  // namespace renderer::KERNEL_NAMESPACE
