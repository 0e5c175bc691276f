// The elastic energy of the yarns by themselves: tension or an axial spring, and bending.
//
// With y(t) the spline, ' = d/dt and L = integral |y'| dt the length of one period, the energies of a yarn are
//   tension    T L
//   axial      EA / 2 (L / L0 - 1)^2 L0: without friction the strain is the same all along the yarn
//   bending    B / 2 integral kappa^2 ds = B / 2 integral |y' x y''|^2 / |y'|^5 dt      (straight at rest, no twist)
// by three Gauss points per segment. No energy depends on where along the yarn its points lie. They are integrals along
// the spline that is rendered, so that the yarn at rest and the one in the picture are one curve.
#pragma once

#include "renderer/weave/weave_model.h"

namespace renderer {

// Adds the energies of all yarns and their derivatives to `sum`.
void add_elasticity(const WeaveModel& model, const Eigen::Matrix3Xd& points, WeaveDerivatives& sum);

}  // namespace renderer
