#include "renderer/trace/rectangle_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace renderer {
namespace {

using Eigen::Vector3d;

// A light whose area over its squared distance is less than this is seen under the same angle all over to 1e-6; the
// angles of its outline, whose sum is the solid angle, begin to suffer from rounding there.
constexpr double kFar = 1e-6;

Vector3d normal_of(const RectangleLight& light) {
  return light.edge_x.cross(light.edge_y).normalized();
}

// How far the point is before the bright side; 0 or less behind it.
double height_over(const RectangleLight& light, const Vector3d& point) {
  return (point - light.center).dot(normal_of(light));
}

double area_of(const RectangleLight& light) {
  return light.edge_x.norm() * light.edge_y.norm();
}

bool is_far(const RectangleLight& light, const Vector3d& point) {
  return area_of(light) < kFar * (light.center - point).squaredNorm();
}

// The rectangle seen from a point before it, in axes along its edges with z away from the viewer: x0..x1, y0..y1,
// z > 0.
struct SphericalRectangle {
  Vector3d x, y, z;
  double x0, x1, y0, y1, depth;
  double b0, b1, k;  // of Ureña et al.
  double solid_angle;

  SphericalRectangle(const RectangleLight& light, const Vector3d& point) {
    x = light.edge_x.normalized(), y = light.edge_y.normalized(), z = -normal_of(light);
    const Vector3d corner = light.center - (light.edge_x + light.edge_y) / 2 - point;
    x0 = corner.dot(x), y0 = corner.dot(y), depth = corner.dot(z);
    x1 = x0 + light.edge_x.norm(), y1 = y0 + light.edge_y.norm();
    const auto side = [](const Vector3d& a, const Vector3d& b) { return a.cross(b).normalized(); };
    const Vector3d v00(x0, y0, -depth), v01(x0, y1, -depth), v10(x1, y0, -depth), v11(x1, y1, -depth);
    const std::array<Vector3d, 4> n{side(v00, v10), side(v10, v11), side(v11, v01), side(v01, v00)};
    const auto angle = [&](std::size_t i) { return std::acos(std::clamp(-n.at(i).dot(n.at((i + 1) % 4)), -1.0, 1.0)); };
    b0 = n[0].z(), b1 = n[2].z();
    k = 2 * std::numbers::pi - angle(2) - angle(3);
    solid_angle = std::max(0.0, angle(0) + angle(1) - k);
  }

  // A direction towards the rectangle, uniform by solid angle.
  Vector3d direction(double u, double v) const {
    const double au = u * solid_angle + k, fu = (std::cos(au) * b0 - b1) / std::sin(au);
    const double cu = std::clamp(std::copysign(1 / std::hypot(fu, b0), fu), -1.0, 1.0);
    const double xu = std::clamp(cu * depth / std::sqrt(std::max(1e-300, 1 - cu * cu)), x0, x1);
    const double d = std::hypot(xu, depth), h0 = y0 / std::hypot(d, y0), h1 = y1 / std::hypot(d, y1);
    const double hv = h0 + v * (h1 - h0), below = 1 - hv * hv;
    const double yv = below > 1e-12 ? std::clamp(hv * d / std::sqrt(below), y0, y1) : y1;
    return (xu * x + yv * y + depth * z).normalized();
  }
};

}  // namespace

double solid_angle(const RectangleLight& light, const Vector3d& point) {
  const double height = height_over(light, point);
  if (!(height > 0)) return 0;
  const double distance2 = (light.center - point).squaredNorm();
  if (is_far(light, point)) return area_of(light) * height / (distance2 * std::sqrt(distance2));
  return SphericalRectangle(light, point).solid_angle;
}

std::optional<double> distance_to(const RectangleLight& light, const Vector3d& origin, const Vector3d& direction) {
  const double height = height_over(light, origin), sinking = -direction.dot(normal_of(light));
  if (!(height > 0 && sinking > 0)) return std::nullopt;
  const double distance = height / sinking;
  const Vector3d from_center = origin + distance * direction - light.center;
  if (std::abs(from_center.dot(light.edge_x)) > light.edge_x.squaredNorm() / 2) return std::nullopt;
  if (std::abs(from_center.dot(light.edge_y)) > light.edge_y.squaredNorm() / 2) return std::nullopt;
  return distance;
}

Vector3d direction_to(const RectangleLight& light, const Vector3d& origin, const Eigen::Vector2f& u) {
  const auto ux = static_cast<double>(u.x()), uy = static_cast<double>(u.y());
  if (is_far(light, origin))
    return (light.center + (ux - 0.5) * light.edge_x + (uy - 0.5) * light.edge_y - origin).normalized();
  return SphericalRectangle(light, origin).direction(ux, uy);
}

}  // namespace renderer
