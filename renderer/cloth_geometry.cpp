#include "renderer/cloth_geometry.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "renderer/cloth_query.h"
#include "renderer/curve_geometry.h"
#include "renderer/weave/patch_curves.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// The yarns' heights, and a little more: they are sampled to 1e-4 of a radius.
SurfaceRange shell_heights(const YarnPatch& patch) {
  const SurfaceRange range = surface_range(patch);
  const double more = 2e-3 * (range.high_mm - range.low_mm);
  return {range.low_mm - more, range.high_mm + more};
}

// A ray that crosses the cloth at 45 degrees stays in the column in which it starts.
double margin_of(const Cloth& cloth) {
  check_cloth(cloth.patch, cloth.threads.size());
  const SurfaceRange heights = shell_heights(cloth.patch);
  return heights.high_mm - heights.low_mm;
}

const ClothGeometry& cloth_of(void* user_pointer) {
  return *static_cast<const ClothGeometry*>(user_pointer);
}

}  // namespace

ClothGeometry::ClothGeometry(const Cloth& cloth, std::uint32_t first_curve_set, RTCDevice device)
    : shell_(make_shell(cloth.surface, shell_heights(cloth.patch))),
      period_mm_(cloth.patch.period_x_mm, cloth.patch.period_y_mm),
      margin_mm_(margin_of(cloth)),
      first_curve_set_(first_curve_set),
      places_(cloth.patch, margin_mm_ + 2 * kShellOverlap) {
  for (const RoundYarns& part : round_yarns_of(cloth.patch))
    for (const int thread : threads_of(part.patch))
      yarns_.push_back({cell_curves_of(part.patch, thread, margin_mm_ + 2 * kShellOverlap),
                        static_cast<std::uint32_t>(thread), part.stretch.cast<float>()});
  column_ = {rtcNewScene(device), rtcReleaseScene};
  rtcSetSceneBuildQuality(column_.get(), RTC_BUILD_QUALITY_HIGH);
  for (const Yarns& yarns : yarns_) {
    if (yarns.stretch == Vector3f::Ones())
      add_curves(device, column_.get(), yarns.curves);
    else
      add_stretched_curves(device, column_.get(), yarns.curves, yarns.stretch);
  }
  rtcCommitScene(column_.get());
}

void ClothGeometry::attach_to(RTCDevice device, RTCScene scene) const {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(shell_.cells.size()));
  rtcSetGeometryUserData(geometry, const_cast<ClothGeometry*>(this));
  rtcSetGeometryBoundsFunction(
      geometry,
      [](const RTCBoundsFunctionArguments* a) {
        const Eigen::AlignedBox3d& box = cloth_of(a->geometryUserPtr).shell_.cells[a->primID].bounds;
        const Vector3f low = (box.min().array() - 2 * kShellOverlap).cast<float>(),
                       high = (box.max().array() + 2 * kShellOverlap).cast<float>();
        *a->bounds_o = {low.x(), low.y(), low.z(), 0, high.x(), high.y(), high.z(), 0};
      },
      nullptr);
  rtcSetGeometryIntersectFunction(geometry, [](const RTCIntersectFunctionNArguments* a) {
    if (a->valid[0]) cloth_of(a->geometryUserPtr).intersect(*a);
  });
  rtcSetGeometryOccludedFunction(geometry, [](const RTCOccludedFunctionNArguments* a) {
    if (a->valid[0]) cloth_of(a->geometryUserPtr).occluded(*a);
  });
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

// Calls visit(ray in the column, tile, start, length) for the pieces of a ray inside one cell, until it returns true.
template <class Visit>
void ClothGeometry::follow(const ShellCell& cell, const Vector3d& origin, const Vector3d& direction, RaySpan within,
                           const Visit& visit) const {
  const std::optional<RaySpan> inside = clip(cell, origin, direction, within);
  if (!inside) return;
  const Vector3d start = cell.patch_from_world * origin.homogeneous(),
                 step = cell.patch_from_world.leftCols<3>() * direction;
  for (double t = inside->begin; t < inside->end;) {
    const Vector3d at = start + t * step;
    Vector3d tile = Vector3d::Zero();
    double length = inside->end - t;
    for (int axis = 0; axis < 2; ++axis) {
      tile[axis] = std::floor(at[axis] / period_mm_[axis]) * period_mm_[axis];
      const double local = at[axis] - tile[axis];
      const double way = step[axis] > 0 ? period_mm_[axis] + margin_mm_ - local : local + margin_mm_;
      length = std::min(length, way / std::abs(step[axis]));
    }
    const double overlapping = std::min(length + kShellOverlap, within.end - t);
    if (visit(Ray{(at - tile).cast<float>(), step.cast<float>()}, tile, t, static_cast<float>(overlapping))) return;
    t += length;
  }
}

void ClothGeometry::intersect(const RTCIntersectFunctionNArguments& arguments) const {
  auto* query = reinterpret_cast<RTCRayHit*>(arguments.rayhit);
  RTCRay& ray = query->ray;
  const auto visit = [&](const Ray& local, const Vector3d& tile, double start, float length) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit found{};
    found.ray = embree_ray(local, length);
    found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(column_.get(), &context, &found);
    if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    const auto distance = static_cast<float>(start + static_cast<double>(found.ray.tfar));
    ray.tfar = std::min(ray.tfar, distance);
    query->hit = found.hit;
    query->hit.geomID = arguments.geomID;
    query->hit.primID = arguments.primID;
    query->hit.instID[0] = arguments.context->instID[0];
    reinterpret_cast<ClothQuery*>(arguments.context)->cloth = {
        .cell = arguments.primID,
        .yarns = found.hit.instID[0] == RTC_INVALID_GEOMETRY_ID ? found.hit.geomID : found.hit.instID[0],
        .segment = found.hit.primID,
        .u = found.hit.u,
        .hit_normal = {found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z},
        .ray = local,
        .distance = found.ray.tfar,
        .tile = tile};
    return true;
  };
  follow(shell_.cells[arguments.primID], Vector3f(ray.org_x, ray.org_y, ray.org_z).cast<double>(),
         Vector3f(ray.dir_x, ray.dir_y, ray.dir_z).cast<double>(),
         {static_cast<double>(ray.tnear), static_cast<double>(ray.tfar)}, visit);
}

void ClothGeometry::occluded(const RTCOccludedFunctionNArguments& arguments) const {
  auto& ray = *reinterpret_cast<RTCRay*>(arguments.ray);
  bool blocked = false;
  const auto visit = [&](const Ray& local, const Vector3d&, double, float length) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay query = embree_ray(local, length);
    rtcOccluded1(column_.get(), &context, &query);
    return blocked = query.tfar < 0;
  };
  follow(shell_.cells[arguments.primID], Vector3f(ray.org_x, ray.org_y, ray.org_z).cast<double>(),
         Vector3f(ray.dir_x, ray.dir_y, ray.dir_z).cast<double>(),
         {static_cast<double>(ray.tnear), static_cast<double>(ray.tfar)}, visit);
  if (blocked) ray.tfar = -std::numeric_limits<float>::infinity();
}

CurvePoint ClothGeometry::point_at(const ClothHit& hit) const {
  const ShellCell& cell = shell_.cells[hit.cell];
  const Yarns& yarns = yarns_[hit.yarns];
  CurvePoint point =
      point_on_curve(yarns.curves, hit.segment, hit.u, hit.hit_normal, hit.ray, hit.distance, yarns.stretch);
  const Vector3d patch = point.position.cast<double>() + hit.tile;
  const Vector3d world = world_from_patch(cell, patch);
  const Eigen::Matrix3f frame = frame_at(shell_, cell, world).cast<float>();
  point.curve_set = first_curve_set_ + yarns.thread;
  point.position = world.cast<float>();
  point.tangent = frame * point.tangent;
  point.normal = frame * point.normal;
  return point;
}

std::size_t ClothGeometry::yarn_bytes() const {
  std::size_t bytes = 0;
  for (const Yarns& yarns : yarns_) bytes += bytes_of(yarns.curves);
  return bytes;
}

std::size_t ClothGeometry::shell_bytes() const {
  return shell_.cells.size() * sizeof(ShellCell) + shell_.frames.size() * sizeof(Eigen::Matrix3d);
}

}  // namespace renderer
