// The yarns of a patch as curves for the ray tracer: an explicit sheet of tiles, or all that reaches into one cell.
//
// Both give the yarns of one thread, so that each thread's CurveSet gets its own scattering model (the caller sets it;
// an empty set has no segments). Positions are those of the patch's frame (mm), with the face towards +z.
#pragma once

#include <vector>

#include "renderer/scene/scene.h"
#include "renderer/weave/patch.h"

namespace renderer {

// The thread indices that occur in the patch, rising.
std::vector<int> threads_of(const YarnPatch& patch);
// Errors: std::runtime_error, one line, when the patch cannot be a cloth of `threads` threads: because of a yarn of
// another thread, or of yarns that reach farther than `kMostReach` periods out of their cell, sideways or up and down.
inline constexpr double kMostReach = 50;
void check_cloth(const YarnPatch& patch, std::size_t threads);

// Round yarns that become yarns of the cloth when stretched by `stretch` (x, y, z).
struct RoundYarns {
  YarnPatch patch;
  std::vector<int> numbers{};  // of each of its yarns among those of the cloth's patch
  Eigen::Vector3d stretch = Eigen::Vector3d::Ones();
};
// The parts of the patch by the shape of their sections; a cloth of round yarns is one part. Elliptical sections are
// stretched in the plane of the cloth, across the yarn's system, as the contact of flattened yarns has them
// (yarn_contact.h).
std::vector<RoundYarns> round_yarns_of(const YarnPatch& patch);

// Whole periods of a patch: x of them from period number first_x on, likewise y.
struct Tiles {
  int x = 1, y = 1;
  int first_x = 0, first_y = 0;
};
// The tiles and all neighbours, along x and y or along y alone, whose yarns reach into them.
Tiles with_neighbours(const YarnPatch& patch, Tiles tiles, bool along_x);
// A sheet of tiles, for brute-force rendering: every yarn runs in one piece from one border of the tiles to the other
// and ends there; curves have no end caps.
CurveSet curves_of(const YarnPatch& patch, const Tiles& tiles, int thread);

// All segments, of whichever periodic image, whose surface can reach the column [-margin, period_x + margin] x
// [-margin, period_y + margin], for the two-scale renderer. A ray that stays inside the column meets exactly what it
// would meet in the infinite cloth. Segments are tested by the box of their control points plus the radius. `origins`,
// when given, gets one entry per segment.
struct SegmentOrigin {
  int yarn;   // number of the yarn in the patch
  int image;  // number of periods by which it is moved across the yarn
};
CurveSet cell_curves_of(const YarnPatch& patch, int thread, double margin_mm = 0.0,
                        std::vector<SegmentOrigin>* origins = nullptr);

}  // namespace renderer
