// Round curves inside Embree: seen from outside only, with exact normals (ray_scene.h).
#pragma once

#include "renderer/ray_scene.h"

namespace renderer {

// Adds the curves as one geometry, whose buffers stay in the set: it must outlive the scene and stay where it is. Hits of
// curves that are placed elsewhere (CurveSet::placed) have the number of the geometry as instID.
void add_curves(RTCDeviceTy* device, RTCSceneTy* scene, const CurveSet& curves);

// Of its control points and segments.
std::size_t bytes_of(const CurveSet& curves);

// Where a ray met segment `segment` at parameter u; `hit_normal`, not unit, is where the curves are round. The ray is in
// the frame in which they are placed, its direction need not be a unit vector; the caller fills in the number of the
// curve set.
CurvePoint point_on_curve(const CurveSet& curves, std::uint32_t segment, float u, const Eigen::Vector3f& hit_normal,
                          const Ray& ray, float distance);

}  // namespace renderer
