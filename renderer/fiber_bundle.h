// A thread as a bundle of parallel fibers placed at random in its circular cross-section (Xia et al. 2025,
// section 3.2).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace renderer {

// Centres (mm, relative to the thread's axis) of up to `max_fibers` fibers: each of at most `max_attempts` tries
// draws a centre uniformly over the area in which the fiber lies inside the thread, and keeps it when its surface is
// at least `min_gap_mm` away from every fiber kept before. The same seed gives the same bundle on every machine.
// Empty when a fiber is thicker than the thread. (The paper's published code draws the radius uniformly, which crowds
// the centre; the area is uniform here.)
std::vector<Eigen::Vector2d> pack_fibers(double thread_radius_mm, double fiber_radius_mm, double min_gap_mm,
                                         int max_attempts, int max_fibers, std::uint64_t seed);

}  // namespace renderer
