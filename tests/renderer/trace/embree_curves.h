// Round curves in Embree, which has nothing in common with the renderer's own trees: what those are compared with.
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "renderer/scene/scene.h"
#include "renderer/trace/ray_hit.h"

namespace renderer {

// Curves as the renderer has them: met from outside only, cut off, placed.
class EmbreeCurves {
 public:
  struct Hit {
    std::uint32_t set, segment;
    float u, distance;
    Eigen::Vector3f normal;  // in the curves' frame, not unit
  };

  // `curves` must outlive it. `bare`: for timing; back sides are met, nothing is cut off.
  explicit EmbreeCurves(const std::vector<CurveSet>& curves, bool bare = false) {
    for (const CurveSet& set : curves) add(set, bare);
    rtcCommitScene(scene_);
    rtcInitIntersectContext(&context_);
  }
  ~EmbreeCurves() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeCurves(const EmbreeCurves&) = delete;
  EmbreeCurves& operator=(const EmbreeCurves&) = delete;

  std::optional<Hit> nearest(const Ray& ray, float distance = std::numeric_limits<float>::infinity()) {
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x(), query.ray.org_y = ray.origin.y(), query.ray.org_z = ray.origin.z();
    query.ray.dir_x = ray.direction.x(), query.ray.dir_y = ray.direction.y(), query.ray.dir_z = ray.direction.z();
    query.ray.tfar = distance;
    query.ray.mask = ~0u;
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context_, &query);
    const RTCHit& hit = query.hit;
    if (hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{.set = hit.instID[0] == RTC_INVALID_GEOMETRY_ID ? hit.geomID : hit.instID[0],
               .segment = hit.primID,
               .u = hit.u,
               .distance = query.ray.tfar,
               .normal = {hit.Ng_x, hit.Ng_y, hit.Ng_z}};
  }

 private:
  static void refuse_back_sides_and_what_is_cut_off(const RTCFilterFunctionNArguments* arguments) {
    const auto* ray = reinterpret_cast<const RTCRay*>(arguments->ray);
    const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
    const Eigen::Vector3f direction(ray->dir_x, ray->dir_y, ray->dir_z);
    const auto beyond = [&](const Eigen::Vector4f& plane) {
      const Eigen::Vector3f place = Eigen::Vector3f(ray->org_x, ray->org_y, ray->org_z) + ray->tfar * direction;
      return plane.head<3>().dot(place) > plane.w();
    };
    if (Eigen::Vector3f(hit->Ng_x, hit->Ng_y, hit->Ng_z).dot(direction) > 0 ||
        std::ranges::any_of(static_cast<const CurveSet*>(arguments->geometryUserPtr)->cut, beyond))
      arguments->valid[0] = 0;
  }

  void add_round_curves(RTCScene scene, const CurveSet& curves, bool bare) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, curves.control_points.data(), 0,
                               sizeof(Eigen::Vector4f), curves.control_points.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, curves.segments.data(), 0,
                               sizeof(std::uint32_t), curves.segments.size());
    rtcSetGeometryUserData(geometry, const_cast<CurveSet*>(&curves));
    if (!bare) rtcSetGeometryIntersectFilterFunction(geometry, refuse_back_sides_and_what_is_cut_off);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }

  void add(const CurveSet& curves, bool bare) {
    if (curves.placed.matrix() == Eigen::Matrix4f::Identity()) return add_round_curves(scene_, curves, bare);
    const RTCScene apart = rtcNewScene(device_);
    add_round_curves(apart, curves, bare);
    rtcCommitScene(apart);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, apart);
    const Eigen::Matrix<float, 3, 4> transform = curves.placed.matrix().topRows<3>();
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(apart);
  }

  RTCDevice device_ = rtcNewDevice(nullptr);
  RTCScene scene_ = rtcNewScene(device_);
  RTCIntersectContext context_{};
};

}  // namespace renderer
