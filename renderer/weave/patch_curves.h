// A patch as curves for the ray tracer: an explicit sheet of tiles, or all that reaches into one cell.
//
// Both return the yarns of one thread, so that each thread's CurveSet gets its own scattering model (the caller sets
// it; an empty set has no segments). Positions are those of the patch's frame (mm), +z the face.
#pragma once

#include <vector>

#include "renderer/scene.h"
#include "renderer/weave/patch.h"

namespace renderer {

// Thread indices that occur in the patch, rising.
std::vector<int> threads_of(const YarnPatch& patch);
// Throws std::runtime_error, one line, when the patch cannot be a cloth of `threads` threads: a yarn of another thread,
// or yarns that reach farther than `kMostReach` periods out of their cell, sideways or up and down.
inline constexpr double kMostReach = 50;
void check_cloth(const YarnPatch& patch, std::size_t threads);

// Yarns that become those of the cloth when stretched by `stretch` (x, y, z), and are round before.
struct RoundYarns {
  YarnPatch patch;
  std::vector<int> numbers{};  // of its yarns among those of the cloth's patch
  Eigen::Vector3d stretch = Eigen::Vector3d::Ones();
};
// The patch by the shape of its sections; one part for a cloth of round yarns. Elliptical sections are stretched in the
// plane of the cloth, across the yarn's system, as the contact of flattened yarns has them (yarn_contact.h).
std::vector<RoundYarns> round_yarns_of(const YarnPatch& patch);

// tiles_x x tiles_y periods, for brute-force rendering: every yarn runs in one piece from one border of the sheet
// [0, tiles_x period_x] x [0, tiles_y period_y] to the other and ends there; curves have no end caps.
CurveSet curves_of(const YarnPatch& patch, int tiles_x, int tiles_y, int thread);

// For the two-scale renderer: every segment, of whichever periodic image, whose surface can reach the column [-margin,
// period_x + margin] x [-margin, period_y + margin]. A ray that stays inside the column meets exactly what it would
// meet in the infinite cloth. Segments are tested by the box of their control points plus the radius. `origins`, when
// given, gets one entry per segment.
struct SegmentOrigin {
  int yarn;   // of the patch
  int image;  // periods that it is moved across the yarn
};
CurveSet cell_curves_of(const YarnPatch& patch, int thread, double margin_mm = 0.0,
                        std::vector<SegmentOrigin>* origins = nullptr);

}  // namespace renderer
