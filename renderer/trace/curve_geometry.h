// Points of round curves that rays have met, with exact normals.
#pragma once

#include "renderer/trace/ray_hit.h"
#include "renderer/trace/spread.h"

namespace renderer {

// Bytes of the set's control points and segments.
std::size_t bytes_of(const CurveSet& curves);

// The point where a ray met segment `segment` at parameter u. `hit_normal`, not unit, is given where the curves are
// round; the ray is given where they are placed, and its direction need not be a unit vector. Hits are on
// sections that are narrower than the round ones by `spread`, while CurvePoint::side and ::out are those of the round
// one. The caller fills in CurvePoint::curve_set.
CurvePoint point_on_curve(const CurveSet& curves, std::uint32_t segment, float u, const Eigen::Vector3f& hit_normal,
                          const Ray& ray, float distance, const Spread& spread = {});

// Moves a point's section by a linear map; its tangent has been moved already.
void place_section(const Eigen::Matrix3f& linear, CurvePoint& point);

}  // namespace renderer
