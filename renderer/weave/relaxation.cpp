#include "renderer/weave/relaxation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>

#include "renderer/weave/crossings.h"
#include "renderer/weave/initial_patch.h"
#include "renderer/weave/patch_measures.h"
#include "renderer/weave/weave_model.h"
#include "renderer/weave/yarn_contact.h"
#include "renderer/weave/yarn_elasticity.h"

namespace renderer {
namespace {

constexpr double kPeriodForce = 1e-5;     // of the force scale: the cell pulls at nothing
constexpr double kAxialStiffness = 1000;  // of a contracted yarn: EA r^2 / B, nearly inextensible

struct Cell {
  WeaveModel model;
  Eigen::Matrix3Xd points;
  ContactList contacts;
};

Cell cell_of(const YarnPatch& patch, const Draft& draft) {
  Cell cell;
  cell.model.period_mm = {patch.period_x_mm, patch.period_y_mm};
  for (const Yarn& yarn : patch.yarns) {
    const YarnSystem& system = yarn.warp ? draft.warp : draft.weft;
    ModelYarn model{.warp = yarn.warp,
                    .first = cell.model.points,
                    .count = static_cast<int>(yarn.control_points.size()),
                    .radius_mm = yarn.radius_mm,
                    .flatness = yarn.flatness,
                    .bending_n_mm2 = bending_of(system)};
    model.length_mm = spline_length(center_line(patch, yarn));
    const double bending_force = model.bending_n_mm2 / (yarn.radius_mm * yarn.radius_mm);
    if (system.contraction > 0) {
      model.axial_n = kAxialStiffness * bending_force;
      model.rest_length_mm = (1 - system.contraction) * model.length_mm;
    } else {
      model.tension_n = system.tension_n;
    }
    model.thickness = yarn.thickness;
    cell.model.points += model.count;
    cell.model.yarns.push_back(std::move(model));
  }
  cell.points.resize(3, cell.model.points);
  for (std::size_t i = 0; i < patch.yarns.size(); ++i)
    for (int k = 0; k < cell.model.yarns[i].count; ++k)
      cell.points.col(cell.model.yarns[i].first + k) = patch.yarns[i].control_points[static_cast<std::size_t>(k)];
  return cell;
}

// Anchors the cloth softly, because it moves about as a whole at no cost: the mean heights of all yarns and the mean
// places of each system across it are held.
void add_anchors(Cell& cell, double stiffness_n_mm) {
  for (const int axis : {0, 1, 2}) {
    Eigen::Matrix3Xd weights = Eigen::Matrix3Xd::Zero(3, cell.model.points);
    for (const ModelYarn& yarn : cell.model.yarns)
      if (axis == 2 || yarn.warp == (axis == 0)) weights.row(axis).segment(yarn.first, yarn.count).setOnes();
    weights /= weights.sum();
    cell.model.anchors.push_back({weights, weights.cwiseProduct(cell.points).sum(), stiffness_n_mm});
  }
}

double thinnest_radius(const WeaveModel& model) {
  double radius = std::numeric_limits<double>::infinity();
  for (const ModelYarn& yarn : model.yarns) {
    radius = std::min(radius, yarn.radius_mm);
    for (const double thick : yarn.thickness) radius = std::min(radius, yarn.radius_mm * thick);
  }
  return radius;
}

// The largest force that pulls at a yarn: the load, or the spring with its contraction, and bending.
double force_scale(const WeaveModel& model) {
  double scale = 0;
  for (const ModelYarn& yarn : model.yarns) {
    const double spring = yarn.axial_n > 0 ? yarn.axial_n * std::abs(yarn.length_mm / yarn.rest_length_mm - 1) : 0;
    scale = std::max(scale, yarn.tension_n + spring + yarn.bending_n_mm2 / (yarn.radius_mm * yarn.radius_mm));
  }
  return scale;
}

WeaveDerivatives derivatives(Cell& cell, const Eigen::Matrix3Xd& points, Curvature curvature) {
  WeaveDerivatives sum(cell.model.points, curvature);
  cell.contacts.update(cell.model, points);
  add_elasticity(cell.model, points, sum);
  cell.contacts.add(cell.model, points, sum);
  for (const Anchor& anchor : cell.model.anchors) sum.add(anchor, points);
  return sum;
}

// The slope of the energy by the periods of the cell when all in it is widened with it.
Eigen::Vector2d cell_force(const Cell& cell, const WeaveDerivatives& sum) {
  return sum.period_gradient +
         sum.gradient.cwiseProduct(cell.points).rowwise().sum().head<2>().cwiseQuotient(cell.model.period_mm);
}

void go_on(const RelaxationOptions& options, const RelaxationReport& so_far) {
  if (options.progress && !options.progress(so_far))
    throw std::runtime_error("the weaving was stopped on request; start it again");
}

MinimizerReport come_to_rest(Cell& cell, double gradient_goal_n, bool quasi_newton, const RelaxationOptions& options,
                             const RelaxationReport& so_far) {
  const Eigen::VectorXi unknowns = unknowns_of(cell.model);
  const auto as_points = [&](const Eigen::VectorXd& x) {
    Eigen::Matrix3Xd points = cell.points;
    for (Eigen::Index i = 0; i < unknowns.size(); ++i)
      if (unknowns[i] >= 0) points.reshaped()[i] = x[unknowns[i]];
    return points;
  };
  const auto as_unknowns = [&](const Eigen::Matrix3Xd& points) {
    Eigen::VectorXd x(unknowns.maxCoeff() + 1);
    for (Eigen::Index i = 0; i < unknowns.size(); ++i)
      if (unknowns[i] >= 0) x[unknowns[i]] = points.reshaped()[i];
    return x;
  };
  const Objective objective{
      .value =
          [&](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
            go_on(options, so_far);
            const WeaveDerivatives sum = derivatives(cell, as_points(x), Curvature::none);
            gradient = as_unknowns(sum.gradient);
            return sum.energy;
          },
      .hessian =
          [&](const Eigen::VectorXd& x, bool exact) {
            go_on(options, so_far);
            return derivatives(cell, as_points(x), exact ? Curvature::exact : Curvature::positive).hessian(unknowns);
          }};
  const MinimizerOptions search{.largest_move = 0.2 * thinnest_radius(cell.model),
                                .gradient_goal = gradient_goal_n,
                                .newton_below = 1e-3 * force_scale(cell.model),
                                .most_quasi_newton = quasi_newton ? 200 : 0};
  Eigen::VectorXd x = as_unknowns(cell.points);
  const MinimizerReport report = minimize(objective, search, x);
  cell.points = as_points(x);
  return report;
}

void add_steps(RelaxationReport& report, const MinimizerReport& minimum) {
  report.quasi_newton_steps += minimum.quasi_newton_steps;
  report.newton_steps += minimum.newton_steps;
  report.factorizations += minimum.factorizations;
  report.gradient = minimum.gradient / report.force_scale_n;
  report.converged = report.gradient <= kAtRest;
  report.energy_n_mm = minimum.energy;
}

double overlap(Cell& cell) {
  cell.contacts.update(cell.model, cell.points);
  return cell.contacts.deepest_overlap(cell.model, cell.points) / thinnest_radius(cell.model);
}

// Stiffens the contact, which begins so soft that the first overlaps are some percent of a radius, until overlaps are
// small.
void stiffen_contact(Cell& cell, const RelaxationOptions& options, RelaxationReport& report) {
  const double radius = thinnest_radius(cell.model);
  cell.model.contact_n_mm2 = 100 * report.force_scale_n / (4 * radius * radius);
  for (report.stages = 1;; ++report.stages) {
    const bool last = report.stages == options.most_stages;
    add_steps(report, come_to_rest(cell, 1e-4 * report.force_scale_n, options.quasi_newton, options, report));
    report.overlap = overlap(cell);
    if (report.overlap <= options.overlap_goal || last) break;
    cell.model.contact_n_mm2 *= 4;
  }
  add_steps(report, come_to_rest(cell, options.gradient_goal * report.force_scale_n, false, options, report));
  report.overlap = overlap(cell);
}

// Brings the cell and all in it to another size.
void resize(Cell& cell, const Eigen::Vector2d& period_mm) {
  const Eigen::Vector2d ratio = period_mm.cwiseQuotient(cell.model.period_mm);
  cell.points.topRows<2>().array().colwise() *= ratio.array();
  for (Anchor& anchor : cell.model.anchors) anchor.value_mm = anchor.weights.cwiseProduct(cell.points).sum();
  cell.model.period_mm = period_mm;
}

// Brings the cell to the size at which nothing pulls at it: Broyden's method on its two forces, with yarns at rest at
// every size.
void settle_periods(Cell& cell, const RelaxationOptions& options, RelaxationReport& report) {
  constexpr int kMostSteps = 40;
  constexpr double kLargestStep = 0.02, kDifference = 1e-4;  // of the period
  const auto force_at = [&](const Eigen::Vector2d& period_mm) -> Eigen::Vector2d {
    resize(cell, period_mm);
    add_steps(report, come_to_rest(cell, options.gradient_goal * report.force_scale_n, false, options, report));
    return cell_force(cell, derivatives(cell, cell.points, Curvature::none));
  };
  Eigen::Vector2d period = cell.model.period_mm, force = force_at(period);
  Eigen::Matrix2d slope;
  for (int axis = 0; axis < 2; ++axis) {
    const double step = kDifference * period[axis];
    slope.col(axis) = (force_at(period + step * Eigen::Vector2d::Unit(axis)) - force) / step;
  }
  for (int step = 0; step < kMostSteps && force.cwiseAbs().maxCoeff() > kPeriodForce * report.force_scale_n; ++step) {
    Eigen::Vector2d move = -slope.fullPivLu().solve(force);
    if (!move.allFinite() || move.dot(force) > 0) move = -force / slope.norm();  // downhill
    move *= std::min(1.0, kLargestStep / move.cwiseQuotient(period).cwiseAbs().maxCoeff());
    const Eigen::Vector2d next = force_at(period + move);
    slope += (next - force - slope * move) * move.transpose() / move.squaredNorm();
    period += move;
    force = next;
  }
  force = force_at(period);
  report.overlap = overlap(cell);
  report.converged = report.converged && force.cwiseAbs().maxCoeff() <= kPeriodForce * report.force_scale_n;
}

double least_crown_gap(const YarnPatch& patch) {
  double least = std::numeric_limits<double>::infinity();
  for (const Crossing& crossing : crossings_of(patch)) {
    const Yarn &warp = patch.yarns[crossing.warp], &weft = patch.yarns[crossing.weft];
    const double contact =
        half_height(warp) * thickness(warp, crossing.warp_t) + half_height(weft) * thickness(weft, crossing.weft_t);
    least = std::min(least, crossing.distance_mm / contact - 1);
  }
  return least;
}

YarnPatch patch_of(const Cell& cell, YarnPatch patch) {
  patch.period_x_mm = cell.model.period_mm.x();
  patch.period_y_mm = cell.model.period_mm.y();
  for (std::size_t i = 0; i < patch.yarns.size(); ++i)
    for (int k = 0; k < cell.model.yarns[i].count; ++k)
      patch.yarns[i].control_points[static_cast<std::size_t>(k)] = cell.points.col(cell.model.yarns[i].first + k);
  return patch;
}

}  // namespace

RelaxedPatch relax(const YarnPatch& start, const Draft& draft, const RelaxationOptions& options) {
  Cell cell = cell_of(start, draft);
  RelaxedPatch relaxed;
  RelaxationReport& report = relaxed.report;
  report.force_scale_n = force_scale(cell.model);
  add_anchors(cell, report.force_scale_n / thinnest_radius(cell.model));
  stiffen_contact(cell, options, report);
  if (draft.free_periods) settle_periods(cell, options, report);

  report.contact_n_mm2 = cell.model.contact_n_mm2;
  std::tie(report.contact_forces_n, report.contact_loads_n) = cell.contacts.forces(cell.model, cell.points);
  report.cell_force_n = cell_force(cell, derivatives(cell, cell.points, Curvature::none));
  YarnPatch patch = patch_of(cell, start);
  report.as_drafted = is_as_drafted(patch, draft);
  report.crown_gap = least_crown_gap(patch);
  report.jammed = report.overlap > kMostOverlap || report.crown_gap > kJammedCrownGap;
  patch.height_scale = draft.height_scale;
  for (Yarn& yarn : patch.yarns)
    for (Eigen::Vector3d& point : yarn.control_points) point.z() *= draft.height_scale;
  measure(patch);
  const bool flattened =
      std::any_of(patch.yarns.begin(), patch.yarns.end(), [](const Yarn& yarn) { return yarn.flatness > 1; });
  if (flattened && report.overlap > 0) patch.least_gap_mm = -report.overlap * thinnest_radius(cell.model);
  relaxed.patch = std::move(patch);
  return relaxed;
}

RelaxedPatch relax(const Draft& draft, const RelaxationOptions& options) {
  Draft unscaled = draft;
  unscaled.height_scale = 1;
  return relax(initial_patch(unscaled, options.points_per_crossing), draft, options);
}

void check_at_rest(const RelaxedPatch& relaxed) {
  const std::string name = "draft \"" + relaxed.patch.name + "\": ";
  if (!relaxed.report.as_drafted)
    throw std::runtime_error(name +
                             "yarns slipped past each other on the way to rest, so the cloth is not as drafted; open "
                             "the sett, take thinner yarns or more tension");
  std::ostringstream gradient;
  gradient << std::setprecision(2) << relaxed.report.gradient;
  if (!relaxed.report.converged)
    throw std::runtime_error(name + "yarns did not come to rest (largest force " + gradient.str() +
                             " of the pull on them); open the sett, take thinner yarns or more tension");
}

}  // namespace renderer
