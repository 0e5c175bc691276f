// Periodic uniform cubic B-splines in space: one period of n control points c_0 .. c_(n-1), then c_(k+n) = c_k +
// period.
//
// The parameter t counts knots: t = 0 .. n is one period, and knot k lies at (c_(k-1) + 4 c_k + c_(k+1)) / 6. Segment
// k, from knot k to knot k + 1, has the four control points c_(k-1) .. c_(k+2). The splines are C2 everywhere, across
// the period too.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace renderer {

struct PeriodicSpline {
  std::vector<Eigen::Vector3d> control_points;  // one period, mm; at least 3
  Eigen::Vector3d period = Eigen::Vector3d::Zero();

  Eigen::Vector3d control_point(int k) const;  // any k
};

// The spline whose knot k is points[k]; at least 3 points. It is linear in the points and exact to rounding.
PeriodicSpline spline_through(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& period);

// The derivative of this order by t (0: the point itself; at most 2), at any t.
Eigen::Vector3d spline_value(const PeriodicSpline& spline, double t, int derivative = 0);

// The weights of the four control points c_(k-1) .. c_(k+2) at u in [0, 1] of segment k, for the derivative of this
// order by t.
Eigen::Vector4d spline_weights(double u, int derivative = 0);

// The arc length of one period, mm (five Gauss points per segment).
double spline_length(const PeriodicSpline& spline);

}  // namespace renderer
