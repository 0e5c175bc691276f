#include "tests/renderer/scattering/plain_circle_tracer.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "renderer/scattering/lobes.h"

namespace renderer {
namespace {

using Eigen::Vector2d;

struct Ray {
  Vector2d position, direction;
  double energy = 1;
  int inside = -1;  // the circle it is in
};

constexpr double kNone = 1e30;

// Distance to where the ray next crosses this circle's border, not the border it stands on.
double crossing(const Ray& ray, const Vector2d& center, double radius, bool inside) {
  const Vector2d to = center - ray.position;
  const double along = to.dot(ray.direction), disc = radius * radius - (to.squaredNorm() - along * along);
  if (disc <= 0) return kNone;
  if (inside) return along + std::sqrt(disc);
  const double distance = along - std::sqrt(disc);
  return distance > 1e-9 * radius ? distance : kNone;
}

}  // namespace

MultiFiberScattering trace_circles_plainly(const MultiFiberOptions& o) {
  std::mt19937_64 engine(o.seed + 77);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  const double sin_theta = std::sin(o.theta_rad), cos_theta = std::cos(o.theta_rad);
  const double plane_eta = std::sqrt(o.eta * o.eta - sin_theta * sin_theta) / cos_theta;
  const double cos_theta_t = std::sqrt(1 - sin_theta * sin_theta / (o.eta * o.eta));
  MultiFiberScattering result;
  std::vector<double> energy(static_cast<std::size_t>(o.bins));
  double entered = 0;
  for (int configuration = 0; configuration < o.configurations; ++configuration) {
    const std::vector<Vector2d> centers = fiber_configuration(o, configuration);
    for (int i = 0; i < o.rays; ++i) {
      Ray ray{{o.thread_radius, (2 * (i + uniform()) / o.rays - 1) * o.thread_radius}, {-1, 0}};
      bool met = false;
      for (;;) {
        double distance = kNone;
        int hit = -1;
        for (int c = 0; c < static_cast<int>(centers.size()); ++c) {
          if (ray.inside >= 0 && c != ray.inside) continue;
          const double d = crossing(ray, centers[static_cast<std::size_t>(c)], o.fiber_radius, c == ray.inside);
          if (d < distance) distance = d, hit = c;
        }
        if (hit < 0) break;
        met = true;
        const Vector2d& center = centers[static_cast<std::size_t>(hit)];
        ray.position += distance * ray.direction;
        const Vector2d normal = (ray.position - center).normalized(), tangent(-normal.y(), normal.x());
        ray.position = center + o.fiber_radius * normal;
        const bool leaving = ray.inside >= 0;
        if (leaving) ray.energy *= std::exp(-o.sigma_a * distance / o.fiber_radius / cos_theta_t);
        const double sine = ray.direction.dot(tangent);
        const double outside_sine = leaving ? sine * plane_eta : sine;
        const double reflectance =
            std::abs(outside_sine) >= 1
                ? 1
                : fresnel_dielectric(cos_theta * std::sqrt(1 - outside_sine * outside_sine), o.eta);
        if (uniform() < reflectance) {
          ray.direction -= 2 * ray.direction.dot(normal) * normal;
        } else {
          const double new_sine = leaving ? outside_sine : sine / plane_eta;
          const double side = leaving ? 1 : -1;
          ray.direction = new_sine * tangent + side * std::sqrt(1 - new_sine * new_sine) * normal;
          ray.inside = leaving ? -1 : hit;
          entered += !leaving;
        }
      }
      if (!met) continue;
      ++result.rays;
      const double phi = std::atan2(ray.direction.y(), ray.direction.x());
      energy[static_cast<std::size_t>(std::min(
          o.bins - 1, static_cast<int>((phi + std::numbers::pi) / (2 * std::numbers::pi) * o.bins)))] += ray.energy;
    }
  }
  const double met = static_cast<double>(result.rays);
  result.miss = 1 - met / (static_cast<double>(o.rays) * o.configurations);
  result.albedo = std::accumulate(energy.begin(), energy.end(), 0.0) / met;
  const auto quarter = o.bins / 4;
  result.back = std::accumulate(energy.begin() + quarter, energy.begin() + 3 * quarter, 0.0) / met;
  result.mean_entered = entered / met;
  for (double e : energy) result.density.push_back(e / met * o.bins / (2 * std::numbers::pi));
  return result;
}

}  // namespace renderer
