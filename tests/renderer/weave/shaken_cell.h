// A cell of yarns away from rest, for laws of its energy that must hold anywhere.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "renderer/weave/initial_patch.h"
#include "renderer/weave/yarn_contact.h"
#include "renderer/weave/yarn_elasticity.h"

namespace renderer {

// The yarns of a draft, pressed into each other and shaken, so that no term is at rest and no symmetry helps.
struct ShakenCell {
  WeaveModel model;
  Eigen::Matrix3Xd points;

  ShakenCell(const Draft& draft, double axial_n, double flatness, unsigned seed, double slub = 0,
             int points_per_crossing = kPointsPerCrossing) {
    const YarnPatch patch = initial_patch(draft, points_per_crossing);
    model.period_mm = {patch.period_x_mm, patch.period_y_mm};
    model.contact_n_mm2 = 100;
    std::vector<Eigen::Vector3d> all;
    for (const Yarn& yarn : patch.yarns) {
      ModelYarn m{.warp = yarn.warp,
                  .first = model.points,
                  .count = static_cast<int>(yarn.control_points.size()),
                  .radius_mm = yarn.radius_mm * 1.05,
                  .flatness = flatness,
                  .bending_n_mm2 = 0.05,
                  .tension_n = axial_n > 0 ? 0 : 0.07,
                  .axial_n = axial_n};
      m.length_mm = spline_length(center_line(patch, yarn));
      m.rest_length_mm = 0.97 * m.length_mm;
      for (int k = 0; slub > 0 && k < m.count; ++k)
        m.thickness.push_back(1 + slub * std::sin(2 * std::numbers::pi * k / m.count));
      model.points += m.count;
      model.yarns.push_back(m);
      all.insert(all.end(), yarn.control_points.begin(), yarn.control_points.end());
    }
    points.resize(3, model.points);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shake(-0.01, 0.01);
    for (int i = 0; i < model.points; ++i)
      points.col(i) = all[static_cast<std::size_t>(i)] + Eigen::Vector3d(shake(random), shake(random), shake(random));
  }

  WeaveDerivatives at(const Eigen::Matrix3Xd& where, Curvature curvature) const {
    ContactList contacts;
    contacts.update(model, points);  // the same samples wherever the points are
    return at(where, curvature, contacts);
  }
  WeaveDerivatives at(const Eigen::Matrix3Xd& where, Curvature curvature, const ContactList& contacts) const {
    WeaveDerivatives sum(model.points, curvature);
    add_elasticity(model, where, sum);
    contacts.add(model, where, sum);
    return sum;
  }
};

}  // namespace renderer
