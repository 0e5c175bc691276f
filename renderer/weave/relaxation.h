// Relaxation: from the analytic shape of a draft to the shape in which its yarns are at rest: tension and bending of
// each yarn against contact with the others, in a cell that repeats.
//
// The energy is that of yarn_elasticity.h and yarn_contact.h; contact stiffens in steps until yarns overlap by no more
// than `overlap_goal`. Source: after Leaf et al. 2018.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "renderer/weave/minimizer.h"
#include "renderer/weave/patch.h"

namespace renderer {

struct RelaxationReport;

struct RelaxationOptions {
  int points_per_crossing = kPointsPerCrossing;  // control points; even
  double overlap_goal = 0.005;                   // largest overlap wanted, as a share of the thinnest yarn's radius
  double gradient_goal = 1e-8;                   // largest component wanted, as a share of force_scale_n
  int most_stages = 10;                          // of contact stiffness, each four times the one before
  bool quasi_newton = false;                     // L-BFGS before Newton
  // Called before each look at the energy, with what is known so far; returning false stops the work.
  std::function<bool(const RelaxationReport& so_far)> progress{};
};

struct RelaxationReport {
  bool converged = false;   // gradient below kAtRest at the last stiffness; rounding may not allow gradient_goal
  bool as_drafted = false;  // at each crossing the yarn lies on top that the draft says
  bool jammed = false;      // yarns have no room in this sett: they overlap by more than kMostOverlap, or have been
                            // squeezed out of the plane until no two touch where they cross (crown_gap)
  double crown_gap = 0.0;   // least free way between two yarns where they cross, as a share of their contact distance
  double gradient = 0.0;    // largest component, as a share of force_scale_n
  double force_scale_n = 0.0;  // largest tension + bending stiffness / radius^2
  double overlap = 0.0;        // deepest at the contact samples, as a share of the thinnest yarn's radius
  double contact_n_mm2 = 0.0;  // stiffness of contact at the end
  int stages = 0, quasi_newton_steps = 0, newton_steps = 0, factorizations = 0;
  double energy_n_mm = 0.0;
  Eigen::Vector2d cell_force_n = Eigen::Vector2d::Zero();  // resistance to widening, d energy / d period
  Eigen::Matrix3Xd contact_forces_n;                       // on each yarn, sum over its contacts
  Eigen::VectorXd contact_loads_n;                         // on each yarn, sum of the magnitudes
};

struct RelaxedPatch {
  YarnPatch patch;
  RelaxationReport report;
};

inline constexpr double kAtRest = 1e-6;       // largest gradient of a patch at rest, as a share of the force scale
inline constexpr double kMostOverlap = 0.01;  // as a share of a radius; a patch that overlaps more is jammed
// The crown gap above which a patch is jammed. In square plain cloth the gap is 1.7 % at p / D = 0.9 (pitch over the
// sum of both diameters), 3.4 % at 0.867, 3.6 % at 0.865, 4.3 % at 0.86; Peirce's geometry jams at 0.866. The gap is
// that between tangents, because crossings at the ends of floats are inclined: heights alone would show 3.3 % in a 2/2
// twill however open.
inline constexpr double kJammedCrownGap = 0.035;

// The patch of a draft at rest; how well it came to rest is in the report. Errors: std::runtime_error with the line of
// check_draft(), or when stopped by `progress`.
RelaxedPatch relax(const Draft& draft, const RelaxationOptions& options = {});
// The same from another start, an initial_patch() whose yarns may differ in radius, flatness, place, and in thickness
// along themselves. Stiffness, load and height scale are the draft's.
RelaxedPatch relax(const YarnPatch& start, const Draft& draft, const RelaxationOptions& options = {});

// Checks that the yarns have come to rest as drafted; jammed cloth passes. Errors: std::runtime_error, one line, where
// they have not.
void check_at_rest(const RelaxedPatch& relaxed);

}  // namespace renderer
