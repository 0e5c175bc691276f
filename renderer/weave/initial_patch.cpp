#include "renderer/weave/initial_patch.h"

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

// The control points of the spline through a path (along, height) in the plane where the other coordinate is
// `across_mm`.
std::vector<Eigen::Vector3d> control_points_of(const std::vector<Eigen::Vector2d>& path, double across_mm, bool warp,
                                               const Eigen::Vector3d& period, double height_scale) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& p : path) {
    const double height = p.y() * height_scale;
    points.push_back(warp ? Eigen::Vector3d(across_mm, p.x(), height) : Eigen::Vector3d(p.x(), across_mm, height));
  }
  return spline_through(points, period).control_points;
}

}  // namespace

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
