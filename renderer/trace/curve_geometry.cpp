#include "renderer/trace/curve_geometry.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

namespace renderer {
namespace {

using Eigen::Vector3f;

Vector3f across(const Vector3f& v, const Vector3f& unit_axis) {
  return v - v.dot(unit_axis) * unit_axis;
}

// The outward normal where a ray, already close to the surface at `point` (relative to the axis), enters the cylinder
// that touches the curve there. The search for hits stops up to 0.0002 radii early; this finishes it.
std::optional<Vector3f> cylinder_normal(const Vector3f& point, const Vector3f& direction, const Vector3f& axis,
                                        float radius) {
  const Vector3f o = across(point, axis), d = across(direction, axis);
  const float a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - radius * radius;
  const float root2 = b * b - a * c;
  if (!(root2 >= 0 && a > 0)) return std::nullopt;  // rounding at the silhouette, or a ray along the axis
  const float step = (-b - std::sqrt(root2)) / a;
  if (std::abs(step) > 0.5f * radius) return std::nullopt;
  return (o + step * d).normalized();
}

Ray unplaced(const Eigen::Affine3f& placed, const Ray& ray) {
  const Eigen::Affine3f inverse = placed.inverse();
  return {inverse * ray.origin, inverse.linear() * ray.direction};
}

// The axis at parameter u of a segment, with the radius there; and the axis's derivative by u.
Eigen::Vector4f center_of(const CurveSet& curves, std::uint32_t segment, float u) {
  const Eigen::Vector4f* p = &curves.control_points[curves.segments[segment]];
  const float w = 1 - u;
  return (w * w * w * p[0] + (4 + 3 * u * u * (u - 2)) * p[1] + (4 + 3 * w * w * (w - 2)) * p[2] + u * u * u * p[3]) /
         6;
}
Vector3f derivative_of(const CurveSet& curves, std::uint32_t segment, float u) {
  const Eigen::Vector4f* p = &curves.control_points[curves.segments[segment]];
  const float w = 1 - u;
  return 0.5f * (-w * w * p[0] + u * (3 * u - 4) * p[1] - w * (3 * w - 4) * p[2] + u * u * p[3]).head<3>();
}

bool is_in_place(const CurveSet& curves) {
  return curves.placed.matrix() == Eigen::Matrix4f::Identity();
}

// Fills in normal and section; the tangent is there already.
void set_section(CurvePoint& point, const Vector3f& from_center, const Vector3f& direction, const Vector3f& hit_normal,
                 float radius) {
  const auto exact = cylinder_normal(from_center, direction, point.tangent, radius);
  point.normal = exact ? *exact : across(hit_normal, point.tangent).normalized();
  point.out = radius * (1 - kStartDepth) * point.normal;
  point.side = point.out.cross(point.tangent);
}

}  // namespace

std::size_t bytes_of(const CurveSet& curves) {
  return curves.control_points.size() * sizeof(Eigen::Vector4f) + curves.segments.size() * sizeof(std::uint32_t);
}

CurvePoint point_on_curve(const CurveSet& curves, std::uint32_t segment, float u, const Vector3f& hit_normal,
                          const Ray& ray, float distance, const Spread& spread) {
  const Eigen::Vector4f center = center_of(curves, segment, u);
  const Vector3f derivative = derivative_of(curves, segment, u);
  const bool in_place = is_in_place(curves);
  CurvePoint point;
  point.axis = CurveAxis(curves, segment, u, center.head<3>(), curves.placed.linear());
  if (in_place && spread.is_none()) {
    point.tangent = derivative.normalized();
    set_section(point, (ray.origin - center.head<3>()) + distance * ray.direction, ray.direction, hit_normal,
                center.w());
    point.position = center.head<3>() + point.out;
    return point;
  }
  const Ray local = in_place ? ray : unplaced(curves.placed, ray);
  // From the patch to the world round the axis, as yarn_grid_kernel.cpp has it.
  const auto wider = [&](float z) {
    const Eigen::Vector2f xy = spread.middle + z * spread.growth;
    return Vector3f(xy.x(), xy.y(), 1);
  };
  const auto fall = [&](const Vector3f& at) {
    const Eigen::Vector2f moved = (curves.placed.linear() * at).head<2>();
    return 0.5f * moved.cwiseAbs2().dot(spread.growth.cwiseQuotient(spread.middle));
  };
  const Vector3f here = wider(local.origin.z() + distance * local.direction.z()),
                 direction = local.direction.cwiseProduct(here);
  Vector3f from_center = (local.origin - center.head<3>()).cwiseProduct(here) + distance * direction;
  from_center.z() -= fall(from_center);
  point.tangent = derivative.cwiseProduct(wider(center.z())).normalized();
  set_section(point, from_center, direction, hit_normal, center.w());
  point.position = center.head<3>() + point.out.cwiseQuotient(here);
  point.position.z() += fall(point.out);
  if (in_place) return point;
  const Eigen::Matrix3f linear = curves.placed.linear();
  point.position = curves.placed * point.position;
  point.normal = (linear.inverse().transpose() * point.normal).normalized();
  point.tangent = (linear * point.tangent).normalized();
  place_section(linear, point);
  return point;
}

CurveAxis::CurveAxis(const CurveSet& curves, std::uint32_t segment, float u, const Vector3f& met,
                     const Eigen::Matrix3f& linear)
    : curves_(&curves), segment_(segment), u_(u), met_(met), linear_(linear) {}

CurveAxis::Place CurveAxis::at(float t) const {
  const std::vector<std::uint32_t>& all = curves_->segments;  // those that go on share control points
  std::uint32_t segment = segment_;
  float u = u_ + t;
  for (; u > 1 && segment + 1 < all.size() && all[segment + 1] == all[segment] + 1; --u) ++segment;
  for (; u < 0 && segment > 0 && all[segment - 1] + 1 == all[segment]; ++u) --segment;
  const float on_curve = std::clamp(u, 0.0f, 1.0f);
  const Vector3f derivative = derivative_of(*curves_, segment, on_curve);
  const Vector3f offset = center_of(*curves_, segment, on_curve).head<3>() + (u - on_curve) * derivative - met_;
  return {linear_ * offset, linear_ * derivative};
}

void place_section(const Eigen::Matrix3f& linear, CurvePoint& point) {
  point.side = across(linear * point.side, point.tangent);
  point.out = across(linear * point.out, point.tangent);
}

}  // namespace renderer
