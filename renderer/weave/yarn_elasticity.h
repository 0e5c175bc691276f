// Elastic energy of the yarns by themselves: tension or an axial spring, and bending.
//
// With y(t) the spline and ' = d/dt, per yarn
//   tension    T integral |y'| dt
//   axial      EA / 2 integral (|y'| / s0 - 1)^2 s0 dt,  s0 = rest length per knot
//   bending    B / 2 integral kappa^2 ds = B / 2 integral |y' x y''|^2 / |y'|^5 dt      (straight at rest, no twist)
//   spread     S / (2 s) integral (d|y'|/dt)^2 dt,  s = length per knot: nothing when the points are evenly spaced
// by three Gauss points per segment. The first three do not know where on the yarn its points lie; the last one does,
// so that points do not drift along it. Source: models.md section 4.2 (there on nodes; here on the spline that is
// rendered, so that both are one curve).
#pragma once

#include "renderer/weave/weave_model.h"

namespace renderer {

void add_elasticity(const WeaveModel& model, const Eigen::Matrix3Xd& points, WeaveDerivatives& sum);

}  // namespace renderer
