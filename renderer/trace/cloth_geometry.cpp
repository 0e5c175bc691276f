#include "renderer/trace/cloth_geometry.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "renderer/scene/patch_curves.h"
#include "renderer/trace/cloth_query.h"
#include "renderer/trace/curve_geometry.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// The heights between which the yarns and their flyaways lie, and a little more, because surface_range() is exact to
// 1e-4 of a radius only.
SurfaceRange shell_heights(const Cloth& cloth, const FlyawayCurves& flyaways) {
  const SurfaceRange range = surface_range(cloth.patch);
  const double more = 2e-3 * (range.high_mm - range.low_mm);
  SurfaceRange heights{range.low_mm - more, range.high_mm + more};
  for (const Eigen::Vector4f& point : flyaways.curves.control_points) {
    heights.low_mm = std::min(heights.low_mm, static_cast<double>(point.z() - point.w()));
    heights.high_mm = std::max(heights.high_mm, static_cast<double>(point.z() + point.w()));
  }
  return heights;
}

FlyawayCurves flyaways_of(const Cloth& cloth) {
  return cloth.flyaways ? flyaway_curves(cloth.patch, *cloth.flyaways) : FlyawayCurves{};
}

// How far yarns are kept beyond the cell. Light goes along among a yarn's fibers for a radius or two before it leaves.
double margin_mm(const Cloth& cloth) {
  constexpr double kRadii = 6;
  const auto is_bundle = [](const ScatteringModel& model) { return std::holds_alternative<BundleParameters>(model); };
  if (std::ranges::none_of(cloth.threads, is_bundle)) return 0;
  double thickest = 0;
  for (const Yarn& yarn : cloth.patch.yarns) thickest = std::max(thickest, yarn.radius_mm);
  return kRadii * thickest;
}

std::vector<ColumnYarns> yarns_of(const Cloth& cloth, const FlyawayCurves& flyaways) {
  check_cloth(cloth.patch, cloth.threads.size());
  std::vector<ColumnYarns> yarns;
  for (const RoundYarns& part : round_yarns_of(cloth.patch))
    for (const int thread : threads_of(part.patch)) {
      yarns.push_back({cell_curves_of(part.patch, thread, margin_mm(cloth)), static_cast<std::uint32_t>(thread)});
      yarns.back().curves.placed = Eigen::Scaling(Vector3f(part.stretch.cast<float>()));
    }
  if (cloth.flyaways) yarns.push_back({flyaways.curves, static_cast<std::uint32_t>(cloth.threads.size())});
  return yarns;
}

std::optional<AbsorptionTexture> checked_absorption(const Cloth& cloth) {
  if (!cloth.absorption) return std::nullopt;
  if (cloth.absorption->sigma_a.empty() || !(cloth.absorption->texel_mm.minCoeff() > 0))
    throw std::runtime_error("cloth: its absorption texture has no texels, or texels without size; give one or more");
  for (const ScatteringModel& thread : cloth.threads)
    if (!std::holds_alternative<ThreadParameters>(thread))
      throw std::runtime_error(
          "cloth: it has an absorption texture, which is for the thread model alone; use threads of that model");
  return cloth.absorption;
}

// The part of a query's ray inside a cell, in the endless patch.
struct PatchRay {
  Vector3d origin, direction;
  double begin;  // distance of the origin along the query's ray
  float length;
};

std::optional<PatchRay> inside(const ShellCell& cell, const RTCRay& ray) {
  const Vector3d origin = Vector3f(ray.org_x, ray.org_y, ray.org_z).cast<double>(),
                 direction = Vector3f(ray.dir_x, ray.dir_y, ray.dir_z).cast<double>();
  const std::optional<RaySpan> span =
      clip(cell, origin, direction, {static_cast<double>(ray.tnear), static_cast<double>(ray.tfar)});
  if (!span) return std::nullopt;
  return PatchRay{cell.patch_from_world * (origin + span->begin * direction).homogeneous(),
                  cell.patch_from_world.leftCols<3>() * direction, span->begin,
                  static_cast<float>(span->end - span->begin)};
}

const ClothGeometry& cloth_of(void* user_pointer) {
  return *static_cast<const ClothGeometry*>(user_pointer);
}

}  // namespace

ClothGeometry::ClothGeometry(const Cloth& cloth, std::uint32_t first_curve_set)
    : ClothGeometry(cloth, flyaways_of(cloth), first_curve_set) {}

ClothGeometry::ClothGeometry(const Cloth& cloth, const FlyawayCurves& flyaways, std::uint32_t first_curve_set)
    : shell_(make_shell(cloth.surface, shell_heights(cloth, flyaways))),
      first_curve_set_(first_curve_set),
      yarns_(yarns_of(cloth, flyaways)),
      grid_(yarns_, {cloth.patch.period_x_mm, cloth.patch.period_y_mm}, shell_.least_spread),
      places_(cloth.patch, margin_mm(cloth)),
      absorption_(checked_absorption(cloth)),
      fibers_(cloth.fibers) {
  if (cloth.flyaways) places_.add(flyaways.origins);
  for (const ScatteringModel& thread : cloth.threads)
    has_fibers_.push_back(fibers_ && std::holds_alternative<ThreadParameters>(thread));
  has_fibers_.push_back(false);  // flyaways
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

void ClothGeometry::intersect(const RTCIntersectFunctionNArguments& arguments) const {
  auto* query = reinterpret_cast<RTCRayHit*>(arguments.rayhit);
  const ShellCell& cell = shell_.cells[arguments.primID];
  const std::optional<PatchRay> ray = inside(cell, query->ray);
  if (!ray) return;
  const std::optional<YarnGrid::Hit> hit = grid_.nearest(ray->origin, ray->direction, ray->length, cell.spread);
  if (!hit) return;
  query->ray.tfar = std::min(query->ray.tfar, static_cast<float>(ray->begin + static_cast<double>(hit->distance)));
  query->hit.geomID = arguments.geomID;
  query->hit.primID = arguments.primID;
  query->hit.instID[0] = arguments.context->instID[0];
  reinterpret_cast<ClothQuery*>(arguments.context)->cloth = {.cell = arguments.primID,
                                                             .yarns = hit->yarns,
                                                             .segment = hit->segment,
                                                             .u = hit->u,
                                                             .hit_normal = hit->normal,
                                                             .ray = {hit->origin, ray->direction.cast<float>()},
                                                             .distance = hit->from_origin,
                                                             .tile = hit->tile};
}

void ClothGeometry::occluded(const RTCOccludedFunctionNArguments& arguments) const {
  auto& query = *reinterpret_cast<RTCRay*>(arguments.ray);
  const ShellCell& cell = shell_.cells[arguments.primID];
  const std::optional<PatchRay> ray = inside(cell, query);
  if (ray && grid_.occluded(ray->origin, ray->direction, ray->length, cell.spread))
    query.tfar = -std::numeric_limits<float>::infinity();
}

CurvePoint ClothGeometry::point_at(const ClothHit& hit) const {
  const ShellCell& cell = shell_.cells[hit.cell];
  const ColumnYarns& yarns = yarns_[hit.yarns];
  CurvePoint point =
      point_on_curve(yarns.curves, hit.segment, hit.u, hit.hit_normal, hit.ray, hit.distance, cell.spread);
  const Vector3d patch = point.position.cast<double>() + hit.tile;
  if (has_fibers_[yarns.thread]) point.fiber = fiber_of(hit, patch, point);
  const Affine3x4 to_world = world_from_patch(cell);
  const Vector3d world = to_world * patch.homogeneous();
  // The section is that of the frame at the yarn's axis.
  const Vector3d axis = to_world * (patch - point.out.cast<double>()).homogeneous();
  const Eigen::Matrix3f frame = frame_at(shell_, cell, axis).cast<float>();
  point.curve_set = first_curve_set_ + yarns.thread;
  point.position = world.cast<float>();
  point.tangent = frame * point.tangent;
  point.normal = frame * point.normal;
  Eigen::Matrix3f section = to_world.leftCols<3>().cast<float>();
  section.leftCols<2>().colwise().normalize();
  place_section(section, point);
  point.axis = point.axis.placed(to_world.leftCols<3>().cast<float>() * yarns.curves.placed.linear());
  if (absorption_) {
    const Eigen::Vector2i texel = absorption_->texel_at(patch.head<2>());
    point.absorption = &absorption_->sigma_a(texel.y(), texel.x());
  }
  return point;
}

FiberAt ClothGeometry::fiber_of(const ClothHit& hit, const Vector3d& place, const CurvePoint& point) const {
  const YarnPlace yarn = yarn_at(hit);
  const Vector3f across = Vector3f::UnitZ().cross(point.tangent).normalized(), up = point.tangent.cross(across);
  const double azimuth = static_cast<double>(std::atan2(point.normal.dot(up), point.normal.dot(across)));
  const auto number = static_cast<std::uint64_t>(2 * static_cast<std::int64_t>(yarn.number) + (yarn.weft ? 1 : 0));
  return fiber_at(*fibers_, yarn.weft ? place.x() : place.y(), azimuth, static_cast<double>(point.out.norm()), number);
}

std::size_t ClothGeometry::yarn_bytes() const {
  std::size_t bytes = 0;
  for (const ColumnYarns& yarns : yarns_) bytes += bytes_of(yarns.curves);
  return bytes;
}

std::size_t ClothGeometry::shell_bytes() const {
  return shell_.cells.size() * sizeof(ShellCell) + shell_.frames.size() * sizeof(Eigen::Matrix3d);
}

}  // namespace renderer
