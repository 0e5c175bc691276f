// The interface of curve_tree_kernel.cpp, which is compiled once for each kind of processor. It has plain numbers only
// (kernel_pieces.h).
#pragma once

#include "renderer/trace/kernel_pieces.h"

namespace renderer {

inline constexpr int kTreeWidth = 8;
inline constexpr int kMostTreeDepth = 40;  // nodes on the way from the root, it included

// Eight boxes; those without content have low > high.
struct alignas(32) CurveTreeNode {
  float bounds[6][kTreeWidth];     // low x, y, z, high x, y, z
  std::int32_t child[kTreeWidth];  // number of the node inside, or -1 - number of the pieces
};

struct CurveTreeData {
  const CurveTreeNode* nodes;  // the first is the root
  const CurvePieces* pieces;
  const CurveSegment* segments;
  const float (*cuts)[4];  // planes (n, d): hits with n . x > d of any are none
  int cut_count;
};

struct CurveTreeRay {
  float origin[3], direction[3];  // the direction's length is near 1
  float length;
};

struct CurveTreeHit {
  std::uint32_t segment;
  float u;
  float distance;
  float normal[3];  // outwards, not unit
};

struct CurveTreeKernel {
  bool (*nearest)(const CurveTreeData&, const CurveTreeRay&, CurveTreeHit&);
  bool (*occluded)(const CurveTreeData&, const CurveTreeRay&);
};

namespace baseline {
extern const CurveTreeKernel kCurveTreeKernel;
}
#if defined(__x86_64__)
namespace avx2 {
extern const CurveTreeKernel kCurveTreeKernel;
}
#endif

}  // namespace renderer
