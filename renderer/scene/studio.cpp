#include "renderer/scene/studio.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "renderer/scene/grid_triangles.h"

namespace renderer {
namespace {

constexpr int kRound = 720, kQuarter = 180;  // steps of half a degree each, so that no shading shows them

// The profile, radius and height, turned round the z axis. Where the radius grows along it the face is above, where the
// height grows inside.
UvMesh turned(const std::vector<Eigen::Vector2d>& profile) {
  UvMesh mesh{.triangles = grid_triangles(kRound, static_cast<int>(profile.size()) - 1)};
  for (const Eigen::Vector2d& at : profile)
    for (int i = 0; i <= kRound; ++i) {
      const double angle = -2 * std::numbers::pi * (i % kRound) / kRound;  // clockwise
      mesh.vertices.emplace_back(at.x() * std::cos(angle), at.x() * std::sin(angle), at.y());
    }
  std::erase_if(mesh.triangles, [&](const auto& triangle) {  // of those in the middle one side has no length
    return (mesh.vertices[triangle[1]] - mesh.vertices[triangle[0]])
        .cross(mesh.vertices[triangle[2]] - mesh.vertices[triangle[0]])
        .isZero();
  });
  return mesh;
}

}  // namespace

UvMesh backdrop_mesh(const BackdropShape& s) {
  if (!(s.bend_mm <= s.radius_mm && s.bend_mm <= s.height_mm))
    throw std::runtime_error("the backdrop bends by more than its floor or its wall is long; make bend_mm smaller");
  std::vector<Eigen::Vector2d> profile{{0, 0}};  // from the middle of the floor to the upper edge
  for (int i = 0; i <= kQuarter; ++i) {
    const double angle = std::numbers::pi / 2 * i / kQuarter;
    profile.emplace_back(s.radius_mm - s.bend_mm * (1 - std::sin(angle)), s.bend_mm * (1 - std::cos(angle)));
  }
  profile.emplace_back(s.radius_mm, s.height_mm);
  return turned(profile);
}

UvMesh form_mesh(const FormShape& s) {
  const double dome_mm = std::min(0.2 * s.radius_mm, s.height_mm);
  std::vector<Eigen::Vector2d> profile;  // from the top down
  for (int i = 0; i <= kQuarter; ++i) {
    const double angle = std::numbers::pi / 2 * i / kQuarter;
    profile.emplace_back(s.radius_mm * std::sin(angle), s.height_mm - dome_mm * (1 - std::cos(angle)));
  }
  profile.emplace_back(s.radius_mm, 0);
  return turned(profile);
}

}  // namespace renderer
