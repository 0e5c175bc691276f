#include "renderer/weave/periodic_spline.h"

#include <array>
#include <cassert>
#include <cmath>

namespace renderer {

Eigen::Vector4d spline_weights(double u, int derivative) {
  const double v = 1 - u;
  assert(derivative >= 0 && derivative <= 2);
  if (derivative == 0)
    return Eigen::Vector4d(v * v * v, 4 - 6 * u * u + 3 * u * u * u, 4 - 6 * v * v + 3 * v * v * v, u * u * u) / 6;
  if (derivative == 1) return Eigen::Vector4d(-v * v, 3 * u * u - 4 * u, 4 * v - 3 * v * v, u * u) / 2;
  return {v, 3 * u - 2, 3 * v - 2, u};
}

Eigen::Vector3d PeriodicSpline::control_point(int k) const {
  const int count = static_cast<int>(control_points.size());
  const int turn = k >= 0 ? k / count : -((count - 1 - k) / count);
  return control_points[static_cast<std::size_t>(k - turn * count)] + turn * period;
}

// (c_(k-1) + 4 c_k + c_(k+1)) / 6 = p_k with the period's jump moved to the right-hand side: a cyclic tridiagonal
// system, solved by Thomas' elimination of the system without its corners and a Sherman-Morrison correction for them.
PeriodicSpline spline_through(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& period) {
  const std::size_t n = points.size();
  assert(n >= 3);
  std::vector<Eigen::Vector3d> c(n);
  std::vector<double> correction(n, 0.0), pivot(n);
  for (std::size_t k = 0; k < n; ++k) c[k] = 6 * points[k];
  c.front() += period;
  c.back() -= period;
  // Corners 1 = u v^T with u = (-4, 0 .. 0, 1), v = (1, 0 .. 0, -1/4); the rest has diagonal 8, 4 .. 4, 4.25.
  correction.front() = -4;
  correction.back() = 1;
  for (std::size_t k = 0; k < n; ++k) {
    const double diagonal = k == 0 ? 8.0 : k + 1 == n ? 4.25 : 4.0;
    const double factor = k == 0 ? 0.0 : 1 / pivot[k - 1];
    pivot[k] = diagonal - factor;
    if (k == 0) continue;
    c[k] -= factor * c[k - 1];
    correction[k] -= factor * correction[k - 1];
  }
  for (std::size_t k = n; k-- > 0;) {
    const bool last = k + 1 == n;
    c[k] = (c[k] - (last ? Eigen::Vector3d::Zero() : c[k + 1])) / pivot[k];
    correction[k] = (correction[k] - (last ? 0.0 : correction[k + 1])) / pivot[k];
  }
  const double denominator = 1 + correction.front() - correction.back() / 4;
  const Eigen::Vector3d share = (c.front() - c.back() / 4) / denominator;
  for (std::size_t k = 0; k < n; ++k) c[k] -= correction[k] * share;
  return {std::move(c), period};
}

Eigen::Vector3d spline_value(const PeriodicSpline& spline, double t, int derivative) {
  const double knot = std::floor(t);
  const int k = static_cast<int>(knot);
  const Eigen::Vector4d weight = spline_weights(t - knot, derivative);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < 4; ++i) sum += weight[i] * spline.control_point(k - 1 + i);
  return sum;
}

double spline_length(const PeriodicSpline& spline) {
  constexpr std::array<double, 3> kAbscissa{0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 3> kWeight{0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  double length = 0;
  for (std::size_t k = 0; k < spline.control_points.size(); ++k) {
    const double middle = static_cast<double>(k) + 0.5;
    const auto speed = [&](double offset) { return spline_value(spline, middle + offset / 2, 1).norm(); };
    length += kWeight[0] / 2 * speed(0);
    for (std::size_t i = 1; i < 3; ++i) length += kWeight[i] / 2 * (speed(kAbscissa[i]) + speed(-kAbscissa[i]));
  }
  return length;
}

}  // namespace renderer
