// Embree's context of a query, with room for what a cloth knows about its hit beyond Embree's own record.
#pragma once

#include <embree3/rtcore.h>

#include <type_traits>

#include "renderer/trace/ray_hit.h"

namespace renderer {

// A query for the nearest hit. In a scene with cloth every such query hands &context to Embree: the cloth's callback
// reaches from there to `cloth`, which it fills in.
struct ClothQuery {
  ClothQuery() { rtcInitIntersectContext(&context); }
  RTCIntersectContext context;  // first member
  ClothHit cloth;
};

// The ray in Embree's form, from its origin to `distance`.
inline RTCRay embree_ray(const Ray& ray, float distance) {
  RTCRay r{};
  r.org_x = ray.origin.x(), r.org_y = ray.origin.y(), r.org_z = ray.origin.z();
  r.dir_x = ray.direction.x(), r.dir_y = ray.direction.y(), r.dir_z = ray.direction.z();
  r.tnear = 0;
  r.tfar = distance;
  r.mask = ~0u;
  return r;
}

static_assert(std::is_standard_layout_v<ClothQuery>, "a pointer to the context must be a pointer to the query");

}  // namespace renderer
