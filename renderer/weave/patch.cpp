#include "renderer/weave/patch.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "renderer/weave/patch_measures.h"
#include "renderer/weave/yarn_path.h"

namespace renderer {
namespace {

Yarn make_yarn(const YarnSystem& system, std::size_t index, bool warp) {
  return {.warp = warp,
          .thread = system.threads[index % system.threads.size()],
          .radius_mm = system.diameter_mm / 2,
          .flatness = system.flatness,
          .tex = system.tex,
          .control_points = {}};
}

// Control points of the spline through a path (along, height) in the plane where the other coordinate is `across_mm`.
std::vector<Eigen::Vector3d> control_points_of(const std::vector<Eigen::Vector2d>& path, double across_mm, bool warp,
                                               const Eigen::Vector3d& period, double height_scale) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& p : path) {
    const double height = p.y() * height_scale;
    points.push_back(warp ? Eigen::Vector3d(across_mm, p.x(), height) : Eigen::Vector3d(p.x(), across_mm, height));
  }
  return spline_through(points, period).control_points;
}

// Place of point k, any k, in a list of `count` for one period.
std::size_t in_period(int k, std::size_t count) {
  const int n = static_cast<int>(count);
  return static_cast<std::size_t>((k % n + n) % n);
}

}  // namespace

double half_width(const Yarn& yarn) {
  return yarn.radius_mm * std::sqrt(yarn.flatness);
}
double half_height(const Yarn& yarn) {
  return yarn.radius_mm / std::sqrt(yarn.flatness);
}

double profile_point(const std::vector<double>& profile, int k) {
  return profile.empty() ? 1 : profile[in_period(k, profile.size())];
}

double profile_value(const std::vector<double>& profile, double t) {
  if (profile.empty()) return 1;
  const double knot = std::floor(t);
  const Eigen::Vector4d weights = spline_weights(t - knot);
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += weights[i] * profile_point(profile, static_cast<int>(knot) - 1 + i);
  return sum;
}

double profile_bound(const std::vector<double>& profile) {
  return profile.empty() ? 1 : *std::max_element(profile.begin(), profile.end());
}

int thread_of_segment(const Yarn& yarn, int k) {
  return yarn.threads.empty() ? yarn.thread : yarn.threads[in_period(k, yarn.threads.size())];
}

Eigen::Vector3d period_of(const YarnPatch& patch, const Yarn& yarn) {
  return yarn.warp ? Eigen::Vector3d(0, patch.period_y_mm, 0) : Eigen::Vector3d(patch.period_x_mm, 0, 0);
}

PeriodicSpline center_line(const YarnPatch& patch, const Yarn& yarn) {
  return {yarn.control_points, period_of(patch, yarn)};
}

YarnPatch initial_patch(const Draft& draft, int points_per_crossing) {
  if (const auto problem = check_draft(draft)) throw std::runtime_error("draft \"" + draft.name + "\": " + *problem);
  const auto ends = static_cast<std::size_t>(ends_in_patch(draft)),
             picks = static_cast<std::size_t>(picks_in_patch(draft));
  YarnPatch patch;
  patch.name = draft.name;
  patch.height_scale = draft.height_scale;
  patch.period_x_mm = static_cast<double>(ends) * draft.warp.pitch_mm;
  patch.period_y_mm = static_cast<double>(picks) * draft.weft.pitch_mm;
  const CrownHeights crown = split_heights(draft.warp, draft.weft);
  const auto& structure = draft.warp_over;
  const auto add_system = [&](bool warp) {
    const YarnSystem& own = warp ? draft.warp : draft.weft;
    const double pitch = warp ? draft.weft.pitch_mm : draft.warp.pitch_mm;  // between this system's crossings
    const HalfWave wave =
        warp ? half_wave(pitch, crown.warp_mm, crown.weft_mm) : half_wave(pitch, crown.weft_mm, crown.warp_mm);
    for (std::size_t k = 0; k < (warp ? ends : picks); ++k) {
      std::vector<bool> on_top;
      for (std::size_t i = 0; i < (warp ? picks : ends); ++i) {
        const std::size_t pick = (warp ? i : k) % structure.size(), end = (warp ? k : i) % structure[0].size();
        on_top.push_back(structure[pick][end] == warp);
      }
      Yarn yarn = make_yarn(own, k, warp);
      const double across = (static_cast<double>(k) + 0.5) * own.pitch_mm;
      yarn.control_points = control_points_of(yarn_path(on_top, pitch, wave, points_per_crossing), across, warp,
                                              period_of(patch, yarn), draft.height_scale);
      patch.yarns.push_back(std::move(yarn));
    }
  };
  add_system(true);
  add_system(false);
  measure(patch);
  return patch;
}

}  // namespace renderer
