// Embree's context of a query, with room for what a cloth knows about its hit beyond Embree's own record.
#pragma once

#include <embree3/rtcore.h>

#include <type_traits>

#include "renderer/cloth_geometry.h"

namespace renderer {

// Every query for the nearest hit in a scene with cloth passes &context: the cloth's callback finds the rest behind it.
struct ClothQuery {
  ClothQuery() { rtcInitIntersectContext(&context); }
  RTCIntersectContext context;  // first member
  ClothHit cloth;
};

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
