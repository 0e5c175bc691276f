// A yarn patch: one period of a woven cloth as yarns in space, the geometry that simulation and rendering share.
//
// Frame of draft.h, millimetres: the cell is [0, period_x) x [0, period_y), its mid-plane z = 0. Warp yarns repeat
// themselves along y, weft yarns along x, and the set of all yarns repeats along both. The cloth lies within z = +-
// thickness / 2 for initial shapes, in general within the slab of surface_range() (patch_measures.h).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "renderer/weave/draft.h"
#include "renderer/weave/periodic_spline.h"

namespace renderer {

// A yarn. Its centre line is a periodic uniform cubic B-spline (periodic_spline.h); its section is round, or an ellipse
// of the same area, wide in the plane of the cloth.
struct Yarn {
  bool warp = true;
  int thread = 0;                               // index into the list of threads that the cloth is made of
  double radius_mm = 0.25;                      // of the round section
  double flatness = 1.0;                        // width / height of the section
  double tex = 0.0;                             // g per km; 0: unknown
  std::vector<Eigen::Vector3d> control_points;  // one period, mm; at least 4

  // Along the yarn, one per control point, or empty for a yarn that is the same all along.
  std::vector<double> thickness{};  // a profile (below): the radius there over radius_mm
  std::vector<double> twist{};  // a profile: the turns per length of its plies over their mean; no part of a patch file
  std::vector<int> threads{};   // instead of `thread`: of the segment that begins at each knot
};

struct YarnPatch {
  std::string name;           // of the draft
  double period_x_mm = 0.0;   // period of the cell across the warp
  double period_y_mm = 0.0;   // period of the cell along the warp
  double height_scale = 1.0;  // already applied to the control points
  std::vector<Yarn> yarns;    // warp ends by rising x, then weft picks by rising y

  // Measured on the splines (patch_measures.h).
  double thickness_mm = 0.0;  // from the lowest to the highest point of the yarns' surfaces
  double crimp_warp = 0.0;    // length of yarn / length of cloth - 1, mean over the warp yarns
  double crimp_weft = 0.0;
  double areal_mass_g_m2 = 0.0;  // 0: unknown, because a yarn's tex is
  double cover = 0.0;            // share of the plane that yarns hide: k1 + k2 - k1 k2, k = diameters / period
  double least_gap_mm = 0.0;     // between the surfaces of any two yarns; negative: how deep they overlap
};

// Half the width and half the height, mm, of the section where the yarn is as thick as its radius; their product is
// radius^2.
double half_width(const Yarn& yarn);
double half_height(const Yarn& yarn);

// A profile holds the control points of a periodic spline with the knots of the centre line; an empty profile is 1
// everywhere. profile_value is its value at t, profile_point its control point k for any k, and profile_bound the
// largest control point, which no value exceeds.
double profile_value(const std::vector<double>& profile, double t);
double profile_point(const std::vector<double>& profile, int k);
double profile_bound(const std::vector<double>& profile);

inline double thickness(const Yarn& yarn, double t) {
  return profile_value(yarn.thickness, t);
}
int thread_of_segment(const Yarn& yarn, int k);  // any k

// The vector after which the yarn repeats itself, mm.
Eigen::Vector3d period_of(const YarnPatch& patch, const Yarn& yarn);
PeriodicSpline center_line(const YarnPatch& patch, const Yarn& yarn);

}  // namespace renderer
