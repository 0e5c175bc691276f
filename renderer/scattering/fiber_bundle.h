// A thread as a bundle of parallel fibers placed at random in its cross-section (Xia et al. 2025, section 3.2).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace renderer {

// How tried centres are spread: evenly over the area, or evenly over the radius as in the paper's published code, which
// crowds the middle.
enum class FiberPlacement { area_uniform, radius_uniform };

// The centres, relative to the thread's axis and in the unit of the arguments, of up to `max_fibers` fibers. Each of at
// most `max_attempts` tries draws a centre from where the fiber lies inside the thread, and keeps it when the fiber's
// surface is at least `min_gap` away from every fiber kept before. The section is a circle, or an ellipse of its area
// that is `flatness` times as wide (x) as it is high (y). The same seed gives the same bundle on every machine. The
// result is empty when a fiber is thicker than the thread.
std::vector<Eigen::Vector2d> pack_fibers(double thread_radius, double fiber_radius, double min_gap, int max_attempts,
                                         int max_fibers, std::uint64_t seed,
                                         FiberPlacement placement = FiberPlacement::area_uniform, double flatness = 1);

}  // namespace renderer
