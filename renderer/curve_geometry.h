// Round curves inside Embree: seen from outside only, with exact normals (ray_scene.h).
#pragma once

#include "renderer/ray_scene.h"

namespace renderer {

// Adds the curves as one geometry, whose buffers stay in the set: it must outlive the scene and stay where it is.
void add_curves(RTCDeviceTy* device, RTCSceneTy* scene, const CurveSet& curves);

// The same stretched by `stretch` (x, y, z): hits of it have the number of the geometry as instID, and segment, parameter
// and normal of the curves before.
void add_stretched_curves(RTCDeviceTy* device, RTCSceneTy* scene, const CurveSet& curves,
                          const Eigen::Vector3f& stretch);

// Of its control points and segments.
std::size_t bytes_of(const CurveSet& curves);

// Where a ray met segment `segment` at parameter u, as Embree reports it with an unnormalised normal; in the frame of
// the curves, stretched. The ray's direction need not be a unit vector; the caller fills in the number of the curve set.
CurvePoint point_on_curve(const CurveSet& curves, std::uint32_t segment, float u, const Eigen::Vector3f& hit_normal,
                          const Ray& ray, float distance, const Eigen::Vector3f& stretch = Eigen::Vector3f::Ones());

}  // namespace renderer
