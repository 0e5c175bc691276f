#include "renderer/trace/curve_tree.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "renderer/trace/curve_pieces.h"

namespace renderer {
namespace {

using Eigen::AlignedBox3f;
using Eigen::Vector3f;

constexpr double kMostOblique = 8;  // of pieces (curve_pieces.h), in radii

const CurveTreeKernel& best_tree_kernel() {
#if defined(__x86_64__)
  if (runs_newest_kernels()) return avx2::kCurveTreeKernel;
#endif
  return baseline::kCurveTreeKernel;
}

bool is_identity(const Eigen::Affine3f& placed) {
  return placed.matrix() == Eigen::Matrix4f::Identity();
}

// Curves while their tree is laid out: all that is kept of each piece, and its box.
struct Parts {
  struct Range {
    std::uint32_t segment;
    float from, to;
  };
  std::vector<const Eigen::Vector4f*> controls;  // of each segment
  std::vector<Range> ranges;                     // of each piece
  std::vector<RTCBuildPrimitive> boxes;          // likewise
};

// What Embree's builder makes: inner nodes and leaves.
struct BuiltNode {
  bool is_leaf;
  unsigned count = 0;
};
struct BuiltInner : BuiltNode {
  BuiltNode* child[kTreeWidth];
  RTCBounds bounds[kTreeWidth];
};
struct BuiltLeaf : BuiltNode {
  unsigned pieces[kPieceLanes];
};

template <class Node>
Node* new_node(RTCThreadLocalAllocator allocator) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
}

// The tree of these boxes; it lies in the memory of `bvh`. Null: there is not enough.
BuiltNode* build(RTCBVH bvh, std::vector<RTCBuildPrimitive>& boxes) {
  RTCBuildArguments a = rtcDefaultBuildArguments();
  a.maxBranchingFactor = kTreeWidth;
  a.maxDepth = kMostTreeDepth - 1;  // leaves are no nodes, but a tree of one leaf gets a root
  a.sahBlockSize = kPieceLanes;
  a.minLeafSize = kPieceLanes;  // else it fills nodes with small leaves
  a.maxLeafSize = kPieceLanes;
  a.bvh = bvh;
  a.primitives = boxes.data();
  a.primitiveCount = a.primitiveArrayCapacity = boxes.size();
  a.createNode = [](RTCThreadLocalAllocator allocator, unsigned count, void*) -> void* {
    auto* node = new_node<BuiltInner>(allocator);
    node->is_leaf = false, node->count = count;
    return static_cast<BuiltNode*>(node);
  };
  a.setNodeChildren = [](void* node, void** children, unsigned count, void*) {
    auto* inner = static_cast<BuiltInner*>(static_cast<BuiltNode*>(node));
    for (unsigned i = 0; i < count; ++i) inner->child[i] = static_cast<BuiltNode*>(children[i]);
  };
  a.setNodeBounds = [](void* node, const RTCBounds** bounds, unsigned count, void*) {
    auto* inner = static_cast<BuiltInner*>(static_cast<BuiltNode*>(node));
    for (unsigned i = 0; i < count; ++i) inner->bounds[i] = *bounds[i];
  };
  a.createLeaf = [](RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* pieces, std::size_t count,
                    void*) -> void* {
    auto* leaf = new_node<BuiltLeaf>(allocator);
    leaf->is_leaf = true, leaf->count = static_cast<unsigned>(count);
    for (std::size_t i = 0; i < count; ++i) leaf->pieces[i] = pieces[i].primID;
    std::sort(leaf->pieces, leaf->pieces + count);  // the order in which threads have left them is chance
    return static_cast<BuiltNode*>(leaf);
  };
  return static_cast<BuiltNode*>(rtcBuildBVH(&a));
}

CurveTreeNode empty_node() {
  CurveTreeNode node{};
  for (int lane = 0; lane < kTreeWidth; ++lane)
    for (int i = 0; i < 6; ++i) node.bounds[i][lane] = i < 3 ? 1e30f : -1e30f;
  return node;
}

void set_box(CurveTreeNode& node, unsigned lane, const RTCBounds& box) {
  const float sides[] = {box.lower_x, box.lower_y, box.lower_z, box.upper_x, box.upper_y, box.upper_z};
  for (int i = 0; i < 6; ++i) node.bounds[i][lane] = sides[i];
}

// The box of a piece, with room for the rounding of rays' places.
RTCBuildPrimitive box_for_embree(const CurvePiece& piece, std::size_t number) {
  const Eigen::AlignedBox3d box = box_of(piece);
  const double more = 1e-6 * std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  const Vector3f low = (box.min().array() - more).cast<float>(), high = (box.max().array() + more).cast<float>();
  return {low.x(), low.y(), low.z(), 0, high.x(), high.y(), high.z(), static_cast<unsigned>(number)};
}

// Adds all segments of the set.
void add_set(const CurveSet& curves, Parts& parts) {
  for (std::size_t i = 0; i < curves.segments.size(); ++i) {
    const Eigen::Vector4f* control = &curves.control_points[curves.segments[i]];
    if (!std::all_of(control, control + 4, [](const Eigen::Vector4f& p) { return p.allFinite(); }))
      throw std::runtime_error("ray tracing: segment " + std::to_string(i) +
                               " of a curve has a control point that is no number; check the yarns");
    const auto number = static_cast<std::uint32_t>(parts.controls.size());
    parts.controls.push_back(control);
    for (const CurvePiece& piece : pieces_of(control, number, kMostOblique)) {
      parts.boxes.push_back(box_for_embree(piece, parts.ranges.size()));
      parts.ranges.push_back({number, static_cast<float>(piece.from), static_cast<float>(piece.to)});
    }
  }
}

RTCBounds bounds_of(const std::vector<RTCBuildPrimitive>& boxes) {
  AlignedBox3f all;
  for (const RTCBuildPrimitive& box : boxes) {
    all.extend(Vector3f(box.lower_x, box.lower_y, box.lower_z));
    all.extend(Vector3f(box.upper_x, box.upper_y, box.upper_z));
  }
  return {all.min().x(), all.min().y(), all.min().z(), 0, all.max().x(), all.max().y(), all.max().z(), 0};
}

// Each adds what Embree has built to nodes or pieces and returns its number as CurveTreeNode::child has it.
std::int32_t add_leaf(const BuiltLeaf& leaf, const Parts& parts, std::vector<CurvePieces>& pieces) {
  pieces.push_back(no_pieces());
  for (unsigned i = 0; i < leaf.count; ++i) {
    const auto& [segment, from, to] = parts.ranges[leaf.pieces[i]];
    put(pieces.back(), static_cast<int>(i),
        piece_of(parts.controls[segment], segment, static_cast<double>(from), static_cast<double>(to)));
  }
  return -static_cast<std::int32_t>(pieces.size());
}

std::int32_t add_inner(const BuiltInner& inner, const Parts& parts, std::vector<CurveTreeNode>& nodes,
                       std::vector<CurvePieces>& pieces) {
  const std::size_t number = nodes.size();
  nodes.push_back(empty_node());
  for (unsigned i = 0; i < inner.count; ++i) {
    const BuiltNode& child = *inner.child[i];
    const std::int32_t added = child.is_leaf ? add_leaf(static_cast<const BuiltLeaf&>(child), parts, pieces)
                                             : add_inner(static_cast<const BuiltInner&>(child), parts, nodes, pieces);
    set_box(nodes[number], i, inner.bounds[i]);
    nodes[number].child[i] = added;
  }
  return static_cast<std::int32_t>(number);
}

}  // namespace

CurveTree::CurveTree(RTCDevice device, const std::vector<CurveSet>& curves, const std::vector<std::uint32_t>& sets)
    : kernel_(&best_tree_kernel()) {
  const CurveSet& first = curves[sets.front()];
  if (!is_identity(first.placed)) from_world_ = first.placed.inverse();
  for (const Eigen::Vector4f& plane : first.cut) cuts_.push_back({plane.x(), plane.y(), plane.z(), plane.w()});

  Parts parts;
  for (const std::uint32_t set : sets) {
    sets_.push_back({set, static_cast<std::uint32_t>(parts.controls.size())});
    add_set(curves[set], parts);
  }
  for (const Eigen::Vector4f* control : parts.controls) segments_.push_back(segment_of(control));
  if (parts.boxes.empty()) {
    nodes_.push_back(empty_node());
    return;
  }
  const RTCBounds all = bounds_of(parts.boxes);
  const AlignedBox3f box(Vector3f(all.lower_x, all.lower_y, all.lower_z),
                         Vector3f(all.upper_x, all.upper_y, all.upper_z));
  bounds_ = box.transformed(first.placed);
  const std::unique_ptr<RTCBVHTy, decltype(&rtcReleaseBVH)> bvh(rtcNewBVH(device), rtcReleaseBVH);
  BuiltNode* root = build(bvh.get(), parts.boxes);
  if (!root) throw std::runtime_error("ray tracing: there is not enough memory for a tree of the curves; free some");
  BuiltInner lone{};  // the root over a single leaf
  lone.count = 1, lone.child[0] = root, lone.bounds[0] = all;
  add_inner(root->is_leaf ? lone : static_cast<const BuiltInner&>(*root), parts, nodes_, pieces_);
}

CurveTreeData CurveTree::data() const {
  return {.nodes = nodes_.data(),
          .pieces = pieces_.data(),
          .segments = segments_.data(),
          .cuts = reinterpret_cast<const float(*)[4]>(cuts_.data()),
          .cut_count = static_cast<int>(cuts_.size())};
}

std::pair<CurveTreeRay, float> CurveTree::local(const Ray& ray, float distance) const {
  Vector3f origin = ray.origin, direction = ray.direction;
  float longer = 1;
  if (from_world_) {
    origin = *from_world_ * origin;
    direction = from_world_->linear() * direction;
    longer = direction.norm();
    direction /= longer;
  }
  return {{{origin.x(), origin.y(), origin.z()},
           {direction.x(), direction.y(), direction.z()},
           std::min(distance * longer, 1e30f)},
          longer};
}

std::optional<CurveTree::Hit> CurveTree::nearest(const Ray& ray, float distance) const {
  const auto [inside, longer] = local(ray, distance);
  CurveTreeHit hit;
  if (!kernel_->nearest(data(), inside, hit)) return std::nullopt;
  const auto after = std::ranges::upper_bound(sets_, hit.segment, {}, &SetBegin::first);
  const SetBegin& set = *(after - 1);
  return Hit{.set = set.set,
             .segment = hit.segment - set.first,
             .u = hit.u,
             .distance = hit.distance / longer,
             .normal = {hit.normal[0], hit.normal[1], hit.normal[2]}};
}

bool CurveTree::occluded(const Ray& ray, float distance) const {
  return kernel_->occluded(data(), local(ray, distance).first);
}

std::size_t CurveTree::bytes() const {
  return nodes_.size() * sizeof(nodes_[0]) + pieces_.size() * sizeof(pieces_[0]) +
         segments_.size() * sizeof(segments_[0]);
}

std::vector<CurveTree> curve_trees(RTCDevice device, const std::vector<CurveSet>& curves) {
  std::vector<std::vector<std::uint32_t>> groups;
  for (std::uint32_t i = 0; i < curves.size(); ++i) {
    const auto same = std::ranges::find_if(groups, [&](const std::vector<std::uint32_t>& group) {
      const CurveSet& other = curves[group.front()];
      return other.placed.matrix() == curves[i].placed.matrix() && other.cut == curves[i].cut;
    });
    if (same == groups.end())
      groups.push_back({i});
    else
      same->push_back(i);
  }
  std::vector<CurveTree> trees;
  for (const std::vector<std::uint32_t>& group : groups) trees.emplace_back(device, curves, group);
  return trees;
}

}  // namespace renderer
