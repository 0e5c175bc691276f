// Light paths through a woven cloth from each crossing of its repeat, traced once and then shaded with any absorption.
//
// The cloth is flat, without end, lit by 1 from everywhere and seen straight from above. A path's value is the product
// of f_cos / density over the threads that it meets on its way out. Which threads a path meets, and where, does not
// depend on their absorption: a path that was traced with another absorption is only weighed by it, which is unbiased,
// and noisier the farther the two differ. As the cloth repeats, so do its paths: those of one crossing serve every
// crossing at the same place in the repeat.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "renderer/scene/scene.h"

namespace inversion {

// A woven repeat in threads whose own absorption is not used.
struct TexturedCloth {
  renderer::YarnPatch patch;
  Eigen::Vector2i crossings;  // warp ends and weft picks in the patch
  std::vector<renderer::ThreadParameters> threads;

  // The width and height of one crossing.
  Eigen::Vector2d crossing_mm() const { return {patch.period_x_mm / crossings.x(), patch.period_y_mm / crossings.y()}; }
};

// f_cos / density of one scattering event is, in each channel,
//   reflected + tt exp(-chord_tt sigma_a) + trt exp(-chord_trt sigma_a).
struct TextureEvent {
  std::array<float, 3> reflected;
  float tt, trt;
  float chord_tt, chord_trt;  // in thread radii
  std::int16_t right, up;     // crossings from that where the path began to that of the event
};

// Paths from random places of one crossing.
struct CrossingPaths {
  std::vector<TextureEvent> events;
  std::vector<std::uint32_t> ends{0};  // path i has events ends[i] .. ends[i + 1] - 1; none: it met no thread
  int traced = 0;  // number of paths, with those that never left the cloth, have no value and are not kept
  std::size_t count() const { return ends.size() - 1; }
};

// The paths of each crossing of the patch, row by row from the largest y as in a texture, traced on all cores. Errors:
// those of ClothGeometry.
std::vector<CrossingPaths> trace_crossing_paths(const TexturedCloth& cloth, int paths_per_crossing, std::uint64_t seed);

// The paths without those that stay at the crossing where they began, whose value does not depend on other crossings.
CrossingPaths those_that_mix(const CrossingPaths& paths);

}  // namespace inversion
