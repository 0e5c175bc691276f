// Round curves in Embree alone, without anything of the renderer: what its own rays are compared with.
#pragma once

#include <embree3/rtcore.h>

#include <limits>

#include "renderer/scene/scene.h"

namespace renderer {

class BareEmbree {
 public:
  // `curves` must outlive it.
  explicit BareEmbree(const CurveSet& curves) {
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, curves.control_points.data(), 0,
                               sizeof(Eigen::Vector4f), curves.control_points.size());
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, curves.segments.data(), 0,
                               sizeof(std::uint32_t), curves.segments.size());
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene_, geometry_);
    rtcCommitScene(scene_);
    rtcInitIntersectContext(&context_);
  }
  ~BareEmbree() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  BareEmbree(const BareEmbree&) = delete;
  BareEmbree& operator=(const BareEmbree&) = delete;

  bool meets(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
    RTCRayHit query{};
    query.ray.org_x = origin.x(), query.ray.org_y = origin.y(), query.ray.org_z = origin.z();
    query.ray.dir_x = direction.x(), query.ray.dir_y = direction.y(), query.ray.dir_z = direction.z();
    query.ray.tfar = std::numeric_limits<float>::infinity();
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context_, &query);
    return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }

 private:
  RTCDevice device_ = rtcNewDevice(nullptr);
  RTCScene scene_ = rtcNewScene(device_);
  RTCGeometry geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
  RTCIntersectContext context_{};
};

}  // namespace renderer
