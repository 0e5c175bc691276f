// The space that a cloth fills round its surface, cut into cells that each map to the endless patch by one affine map:
// a shell map (Porumbescu et al. 2005).
//
// Every triangle of the surface becomes a prism between the patch's lowest and highest point. Where the surface bends
// there, the prism is made up of three tetrahedra; the diagonals of neighbouring prisms meet, so the map has no gaps
// and no jumps. Inside a cell a straight ray in the world is a straight ray in the patch, with the same parameter along
// it: no ray has to remember in which scale it is, rays may start, end and be blocked anywhere, and on a flat surface
// nothing is approximated. On a curved surface the yarns bend at the faces of the cells, by the angle between
// neighbouring triangles. (To enter at the mid-surface and follow the ray in the flat patch until it leaves would need
// a limit for grazing rays, and would bend light instead of yarns.) Yarns are as thick everywhere as on a flat surface,
// although the patch is stretched where the surface is, and above or below the middle of a bent one (spread.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "renderer/scene/scene.h"
#include "renderer/trace/spread.h"
#include "renderer/weave/patch_measures.h"

namespace renderer {

using Affine3x4 = Eigen::Matrix<double, 3, 4>;  // linear part and translation

// A cell: a tetrahedron, or a whole prism over a triangle without bend.
struct ShellCell {
  // Distances from the cell's faces as shares of its extent; all are >= 0 inside. The first `corners` rows are the
  // barycentric weights of the corners (tetrahedron) or of the triangle's corners (prism).
  Eigen::Matrix<double, 5, 4> inside_from_world = Eigen::Matrix<double, 5, 4>::Zero();
  int faces = 4, corners = 4;
  std::array<std::uint32_t, 4> vertex{};  // the surface's vertex above, below or at which each corner lies
  Affine3x4 patch_from_world;             // mm to mm; rows x, y, z of the endless patch
  Spread spread{};
  Eigen::AlignedBox3d bounds;  // world
};

// The inverse of patch_from_world. It is computed anew for every hit instead of stored, because a garment has a hundred
// thousand cells.
Affine3x4 world_from_patch(const ShellCell& cell);

struct ClothShell {
  std::vector<ShellCell> cells;
  std::vector<Eigen::Matrix3d> frames;  // per vertex of the surface: world from patch, a rotation
  float least_spread = 1;               // of all cells at all heights, at most 1
};

// The shell of a cloth on this surface between these heights. Errors: std::runtime_error with one line when the surface
// is not a surface (indices, lengths, triangles without area), turns the wrong way round, or bends more sharply than
// the cloth is thick.
ClothShell make_shell(const ClothSurface& surface, const SurfaceRange& heights);

// The part [begin, end] of the ray origin + t direction that lies inside the cell, or nothing. It is up to
// `kShellOverlap` longer at both ends, so that rounding leaves no gap between cells.
inline constexpr double kShellOverlap = 1e-3;  // mm, for unit directions
struct RaySpan {
  double begin, end;
};
std::optional<RaySpan> clip(const ShellCell& cell, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                            RaySpan within);

// The rotation world from patch at a point of the cell, which changes smoothly over the surface. It neglects shear and
// stretch of the patch on the surface and is meant for directions only.
Eigen::Matrix3d frame_at(const ClothShell& shell, const ShellCell& cell, const Eigen::Vector3d& world);

}  // namespace renderer
