// Where rays enter pieces of curves: eight pieces are tested at a time, and those whose cylinder the ray meets are
// solved for exactly. Included by kernels alone, each of which is compiled once for each kind of processor.
//
// Where the world is wider than the patch of a cloth, or narrower, yarns are not. There (`spread`) the place where the
// ray enters is taken from the patch to the world round the yarn's axis: stretched, and lowered as the surface falls
// away from its tangent there.
//
// A hit is where the ray enters the surface { c(u) + r(u) n : n unit, n . c'(u) = 0 }. At a trial u the ray is
// intersected with the cone that touches the curve there; the distance along the axis by which that point misses the
// disc at u gives the next u by Newton's method. Because the cone touches the curve, its point moves only in second
// order with u. [the idea of Reshetov and Luebke 2018, doi 10.1145/3233307]
#pragma once

#include "renderer/trace/kernel_pieces.h"

#if defined(__SSE__)
#include <immintrin.h>
#endif

#if defined(__AVX2__) && defined(THREADSTATION_KERNEL_AVX2)
#define KERNEL_NAMESPACE avx2
#else
#define KERNEL_NAMESPACE baseline
#endif

namespace renderer::KERNEL_NAMESPACE {
namespace {

typedef float Float8 __attribute__((vector_size(32)));
typedef std::int32_t Int8 __attribute__((vector_size(32)));
typedef float Float4 __attribute__((vector_size(16)));

constexpr float kFar = 1e30f;
constexpr int kMostSteps = 8;
// The error along the axis, in radii, at which the search ends. It moves the normal by as much, a quarter of what
// Embree leaves.
constexpr float kConverged = 5e-4f;
// The error along the axis, in radii, from which one more step along it is enough: the surface bends away from the cone
// by at most its half square.
constexpr float kNearlyThere = 0.02f;
constexpr float kOnSurface = 2e-5f;  // in radii squared
// In radii squared: rays that start deeper than this start inside. Scattered rays start a thousandth of a radius deep,
// which is 2e-3 here.
constexpr float kInside = 5e-4f;
constexpr float kPastEnds = 1e-3f;  // of a segment: neighbours overlap, so that rounding leaves no gap

#define INLINE inline __attribute__((always_inline))

INLINE Float8 load8(const float* from) {
  return *reinterpret_cast<const Float8*>(from);
}

INLINE Float8 sqrt8(Float8 a) {
#if defined(__AVX__)
  return _mm256_sqrt_ps(a);
#else
  Float8 root;
  for (int i = 0; i < 8; ++i) root[i] = __builtin_sqrtf(a[i]);
  return root;
#endif
}

INLINE unsigned bits8(Int8 mask) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
#else
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= mask[i] ? 1u << i : 0u;
  return bits;
#endif
}

INLINE Float8 min8(Float8 a, Float8 b) {
  return a < b ? a : b;
}
INLINE Float8 max8(Float8 a, Float8 b) {
  return a > b ? a : b;
}

INLINE float dot3(Float4 a, Float4 b) {
  const Float4 product = a * b;
  return product[0] + product[1] + product[2];
}

// A ray in the space in which the pieces are round; the fourth components are 0.
struct LocalRay {
  Float4 origin, direction;
};

// The spread is `middle` + `growth` z at height z, the surface's curvature growth / middle. Where the yarns are round.
struct Stretch {
  Float4 middle, growth, curvature;
};

INLINE Float4 stretch_at(const Stretch& stretch, float z) {
  return stretch.middle + z * stretch.growth;
}

// Takes the ray w + t d, relative to the yarn's axis, from the patch to the world, as it is at t; z: its height there.
INLINE void spread_ray(const Stretch& stretch, float t, float z, Float4& w, Float4& d) {
  const Float4 by = stretch_at(stretch, z);
  w *= by, d *= by;
  const Float4 at = w + t * d;
  w[2] -= 0.5f * dot3(stretch.curvature * at, at);
}

// From the axis at u to o, with minus the radius there as the last component. What cancels is subtracted first: far
// from the origin the rounding is then the same for every u, and searches by u end.
INLINE Float4 from_axis(const Float4* k, Float4 o, float u) {
  return (o - k[0]) - u * (k[1] + u * (k[2] + u * k[3]));
}

struct Solution {
  float t, u;
  Float4 normal;
};

// Where a ray crosses the plane of the yarn's disc at u: at t, and outside of the disc by |q|^2 - r^2, with the slope
// of that. It is for rays that run along the yarn.
struct Crossing {
  float outside, slope, t, r;
  Float4 q;
};

template <bool spread>
INLINE Crossing cross(const Float4* k, Float4 o, Float4 unstretched, const Stretch& stretch, float u) {
  Float4 c1 = k[1] + u * (2 * k[2] + u * (3 * k[3])), c2 = 2 * k[2] + (6 * u) * k[3];
  Float4 w = from_axis(k, o, u), d = unstretched;
  const float r = -w[3], height = o[2] - w[2];
  if (spread) {
    const float near = -dot3(w, c1) / dot3(d, c1);
    spread_ray(stretch, near, o[2] + near * d[2], w, d);
    c1 *= stretch_at(stretch, height), c2 *= stretch_at(stretch, height);
  }
  const float t = -dot3(w, c1) / dot3(d, c1);
  const Float4 q = w + t * d;
  const float dt_du = (dot3(c1, c1) - dot3(q, c2)) / dot3(d, c1);
  return {dot3(q, q) - r * r, 2 * (dot3(q, d) * dt_du - r * c1[3]), t, r, q};
}

// Makes the place exact where the ray enters between a crossing that lies outside, `before`, and one inside, `after`.
template <bool spread>
INLINE bool enter(const Float4* k, Float4 o, Float4 d, const Stretch& stretch, float before, float after, float at,
                  float near, float most, Solution& found) {
  for (int step = 0; step < kMostSteps; ++step) {
    const Crossing x = cross<spread>(k, o, d, stretch, at);
    if (x.outside * x.outside < kOnSurface * kOnSurface * x.r * x.r * x.r * x.r) {
      const float distance = near + x.t;
      if (!(distance > 0) || !(distance <= most)) return false;
      found.t = distance, found.u = at < 0 ? 0 : (at > 1 ? 1 : at), found.normal = x.q;
      return true;
    }
    (x.outside > 0 ? before : after) = at;
    const float next = at - x.outside / x.slope;
    at = (next - before) * (next - after) < 0 ? next : 0.5f * (before + after);
  }
  return false;
}

// The same as solve() for a ray that runs along the yarn within 33 degrees: of eight crossings, the first that lies
// inside after one that lies outside is made exact. A ray that only grazes the yarn is inside between two of them.
template <bool spread>
INLINE bool solve_along(const Float4* k, Float4 o, Float4 d, const Stretch& stretch, bool forward, float low,
                        float high, float near, float most, Solution& found) {
  const Float8 share = {0, 1 / 7.0f, 2 / 7.0f, 3 / 7.0f, 4 / 7.0f, 5 / 7.0f, 6 / 7.0f, 1};
  const float start = forward ? low : high, span = forward ? high - low : low - high;
  const Float8 u = start + span * share;
  Float8 w[3], v[3], c1[3], along = {}, speed = {};
  for (int i = 0; i < 3; ++i) {
    w[i] = (o[i] - k[0][i]) - u * (k[1][i] + u * (k[2][i] + u * k[3][i]));
    v[i] = d[i] + Float8{};
    c1[i] = k[1][i] + u * (2 * k[2][i] + u * (3 * k[3][i]));
    along += w[i] * c1[i], speed += v[i] * c1[i];
  }
  if (spread) {
    const Float8 at = -along / speed, z = o[2] + at * d[2];
    Float8 lower = {};
    const Float8 center_z = o[2] - w[2];
    for (int i = 0; i < 2; ++i) {
      const Float8 by = stretch.middle[i] + z * stretch.growth[i];
      w[i] *= by, v[i] *= by, c1[i] *= stretch.middle[i] + center_z * stretch.growth[i];
      lower += stretch.curvature[i] * (w[i] + at * v[i]) * (w[i] + at * v[i]);
    }
    w[2] -= 0.5f * lower;
    along = w[0] * c1[0] + w[1] * c1[1] + w[2] * c1[2], speed = v[0] * c1[0] + v[1] * c1[1] + v[2] * c1[2];
  }
  const Float8 t = -along / speed, r = k[0][3] + u * (k[1][3] + u * (k[2][3] + u * k[3][3]));
  Float8 outside = -r * r;
  for (int i = 0; i < 3; ++i) outside += (w[i] + t * v[i]) * (w[i] + t * v[i]);
  const unsigned out = bits8(outside > 0.0f);
  if (out == 0xffu) {
    // The lowest of the parabola through the lowest three, where all eight are outside.
    int lowest = 1;
    for (int i = 2; i < 7; ++i) lowest = outside[i] < outside[lowest] ? i : lowest;
    const float slope = outside[lowest + 1] - outside[lowest - 1],
                bend = outside[lowest + 1] - 2 * outside[lowest] + outside[lowest - 1];
    const bool between = outside[lowest] <= outside[lowest - 1] && outside[lowest] <= outside[lowest + 1];
    if (!between || !(bend > 0) || !(outside[lowest] - slope * slope / (8 * bend) < 0)) return false;
    const float dip = u[lowest] - (u[1] - u[0]) * slope / (2 * bend), before = u[lowest - 1];
    return cross<spread>(k, o, d, stretch, dip).outside < 0 &&
           enter<spread>(k, o, d, stretch, before, dip, 0.5f * (before + dip), near, most, found);
  }
  for (unsigned enters = out & ~(out >> 1) & 0x7fu; enters; enters &= enters - 1) {
    const int i = __builtin_ctz(enters);
    const float at = u[i] + (u[i + 1] - u[i]) * outside[i] / (outside[i] - outside[i + 1]);
    if (enter<spread>(k, o, d, stretch, u[i], u[i + 1], at, near, most, found)) return true;
  }
  return false;
}

// How a ray comes near the pieces of a batch.
struct Approach {
  Float8 near;         // t there; 0: it may start inside
  Float8 guess, last;  // the parameters there, and where it leaves them
};

// Finds where the ray enters the piece of this lane, at t > 0 and before `most`.
template <bool spread>
INLINE bool solve(const CurveSegment* segments, const CurvePieces& p, int lane, const Approach& approach, LocalRay ray,
                  const Stretch& stretch, float most, Solution& found) {
  const float from = p.from[lane], to = p.to[lane];
  const float near = approach.near[lane], guess = approach.guess[lane], last = approach.last[lane];
  Float4 k[4];
  for (int i = 0; i < 4; ++i) k[i] = *reinterpret_cast<const Float4*>(segments[p.segment[lane]].power[i]);
  const Float4 o = ray.origin + near * ray.direction;
  Float4 d = ray.direction;
  float dd = dot3(d, d);
  const float low = from - kPastEnds, high = to + kPastEnds;
  const float middle = 0.5f * (from + to);
  const Float4 axis = k[1] + middle * (2 * k[2] + middle * (3 * k[3]));
  const float speed = dot3(d, axis);
  if (speed * speed > 0.7f * dd * dot3(axis, axis)) {
    // Where the ray is near the yarn, and as much further as discs lean.
    const float more = p.axial_slack[lane] / __builtin_sqrtf(dot3(axis, axis)) + kPastEnds;
    const float least = (guess < last ? guess : last) - more, greatest = (guess < last ? last : guess) + more;
    return solve_along<spread>(k, o, d, stretch, speed > 0, low > least ? low : least,
                               high < greatest ? high : greatest, near, most, found);
  }
  float u = guess, bend = 0, met_at = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    Float4 c1 = k[1] + u * (2 * k[2] + u * (3 * k[3])), c2 = 2 * k[2] + (6 * u) * k[3];
    Float4 w = from_axis(k, o, u);
    const float r = -w[3], height = o[2] - w[2];
    if (spread) {
      d = ray.direction;
      spread_ray(stretch, met_at, o[2] + met_at * d[2], w, d);
      dd = dot3(d, d);
      c1 *= stretch_at(stretch, height), c2 *= stretch_at(stretch, height);
    }
    const float along2 = dot3(c1, c1), inv = 1 / along2;
    const float wa = dot3(w, c1), da = dot3(d, c1);
    // The cone's radius at w + t d is r + widening (wa + t da); where the yarn bends towards the ray, the cone widens
    // more quickly.
    const float widening = c1[3] / (along2 - bend);
    const float across = r + widening * wa, widens = widening * da;
    const float a = dd - da * da * inv - widens * widens;
    const float b = dot3(w, d) - wa * da * inv - across * widens;
    const float cc = dot3(w, w) - wa * wa * inv - across * across;
    // A ray that starts inside leaves the yarn without a hit.
    if (step == 0 && near == 0 && cc < -kInside * r * r && wa * wa < kInside * r * r * along2) return false;
    const float disc = b * b - a * cc;
    const bool met = disc > 0;
    const float root = met ? __builtin_sqrtf(disc) : 0.0f;
    // Where the ray enters, (-b - root) / a.
    if (!(b < 0) && !(a > 1e-9f * dd)) return false;  // along the yarn: met where that bends, in another piece
    const float t = met && b < 0 ? cc / (root - b) : (-b - root) / a;
    const Float4 q = w + t * d;
    met_at = t;
    const float miss = wa + t * da;
    bend = dot3(q, c2);
    if (bend > 0.9f * along2) bend = 0.9f * along2;
    float slope = bend - along2;
    if (root * root > 0.01f * r * r * dd) slope -= da * miss * bend * inv / root;
    if (!(slope < -0.05f * along2)) slope = -0.05f * along2;
    if (miss * miss < kConverged * kConverged * r * r * along2 && (!spread || step > 0)) {
      const float distance = near + t;
      if (!met || u < low || u > high || !(distance > 0) || !(distance <= most)) return false;
      found.t = distance, found.u = u < 0 ? 0 : (u > 1 ? 1 : u), found.normal = q;
      return true;
    }
    const float next = u - miss / slope;
    // Near enough: the cone's point will not move, except where the ray hardly touches it.
    if (!spread && root * root > 0.05f * r * r * dd && miss * miss < kNearlyThere * kNearlyThere * r * r * along2) {
      const float distance = near + t;
      if (next < low || next > high || !(distance > 0) || !(distance <= most)) return false;
      found.t = distance, found.u = next < 0 ? 0 : (next > 1 ? 1 : next);
      found.normal = from_axis(k, o, next) + t * d;
      return true;
    }
    // Clearly beyond either end: the yarn is met in another piece or not at all.
    const float change = next - u, room = 0.1f * (to - from) + 0.5f * (change < 0 ? -change : change);
    if (next < from - room || next > to + room) return false;
    u = next;
  }
  return false;
}

// The pieces of the batch that the ray may meet before `most`, as bits.
template <bool spread>
INLINE unsigned candidates(const CurvePieces& p, LocalRay ray, const Stretch& stretch, float most, Approach& approach) {
  const Float4 o = ray.origin, d = ray.direction;
  Float8 ox = o[0] - load8(p.base_x), oy = o[1] - load8(p.base_y);
  const Float8 oz = o[2] - load8(p.base_z);
  Float8 ax = load8(p.axis_x), ay = load8(p.axis_y), az = load8(p.axis_z);
  Float8 dx = d[0] + Float8{}, dy = d[1] + Float8{};
  Float8 radius2 = load8(p.radius2), low = load8(p.low), high = load8(p.high), inverse_length = load8(p.inverse_length);
  if (spread) {
    // The stretch is that of the middle; a little room is for the rest.
    const Float8 z = load8(p.base_z) + 0.5f * (low + high) * az;
    const Float8 by_x = stretch.middle[0] + z * stretch.growth[0], by_y = stretch.middle[1] + z * stretch.growth[1];
    ox *= by_x, dx *= by_x, ax *= by_x, oy *= by_y, dy *= by_y, ay *= by_y;
    const Float8 longer = sqrt8(ax * ax + ay * ay + az * az), shorter = 1.0f / longer;
    ax *= shorter, ay *= shorter, az *= shorter;
    const float growth = __builtin_fabsf(stretch.growth[0]) + __builtin_fabsf(stretch.growth[1]);
    const Float8 room = growth * (high - low + sqrt8(max8(radius2, Float8{})));
    radius2 *= 1 + 2 * room;
    const Float8 lean = room * (high - low);
    low = low * longer - lean, high = high * longer + lean, inverse_length *= shorter;
  }
  const Float8 da = dx * ax + dy * ay + d[2] * az, oa = ox * ax + oy * ay + oz * az;
  const Float8 dd = spread ? dx * dx + dy * dy + d[2] * d[2] : Float8{} + dot3(d, d);
  const Float8 px = ox - oa * ax, py = oy - oa * ay, pz = oz - oa * az;  // across the axis: nothing cancels later
  const Float8 a = max8(dd - da * da, Float8{} + 1e-9f);
  const Float8 b = px * dx + py * dy + pz * d[2];
  // Where the ray passes the axis, and how far from it: b^2 - a c would cancel far away.
  const Float8 inv_a = 1.0f / a, middle = -b * inv_a;
  const Float8 qx = px + middle * (dx - da * ax), qy = py + middle * (dy - da * ay),
               qz = pz + middle * (d[2] - da * az);
  const Float8 room2 = radius2 - (qx * qx + qy * qy + qz * qz);
  const Float8 size = da < 0.0f ? -da : da;
  Int8 possible = (room2 >= 0.0f) & (b <= load8(p.slack) + load8(p.axial_slack) * size);
  if (!bits8(possible)) return 0;
  const Float8 root = sqrt8(max8(room2, Float8{}) * inv_a);
  const Float8 speed = da < 0.0f ? min8(da, Float8{} - 1e-20f) : max8(da, Float8{} + 1e-20f), inv_speed = 1.0f / speed;
  const Float8 t_low = (low - oa) * inv_speed, t_high = (high - oa) * inv_speed;
  const Float8 near = max8(max8(middle - root, min8(t_low, t_high)), Float8{});
  const Float8 end = min8(min8(middle + root, max8(t_low, t_high)), Float8{} + most);
  possible &= near <= end;
  const Float8 from = load8(p.from), to = load8(p.to), zero = {}, one = zero + 1.0f;
  approach.near = near;
  approach.guess = from + (to - from) * min8(max8((oa + near * da) * inverse_length, zero), one);
  approach.last = from + (to - from) * min8(max8((oa + end * da) * inverse_length, zero), one);
  return bits8(possible);
}

}  // namespace
}  // namespace renderer::KERNEL_NAMESPACE
