// A triangle mesh with uv coordinates, which say from which place of the flat cloth each vertex was cut, and the
// surface for woven cloth that it makes.
//
// Garments come as meshes whose uv coordinates are the flat pattern pieces. Where pieces are sewn together their
// vertices stand twice, with different uv: the cloth goes on through the seam without a gap, the weave does not.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "renderer/scene/scene.h"

namespace renderer {

// A mesh whose triangles turn counter-clockwise seen from the cloth's face.
struct UvMesh {
  std::vector<Eigen::Vector3d> vertices{};
  std::vector<Eigen::Vector2d> uv{};  // per vertex, (0, 0) lower left; may be empty
  std::vector<std::array<std::uint32_t, 3>> triangles{};
};

struct UvPlacement {
  double unit_mm = 1;   // of one unit of the mesh's coordinates
  double uv_mm = 0;     // of one unit of uv; 0: such that the mesh's area in the world is its area in the cloth
  double turn_rad = 0;  // of the weave in the pattern, counter-clockwise
};

// The mesh as a surface for cloth. Normals are the means of the triangles' normals round each place, weighted by the
// triangles' angles there, and the same on both sides of a seam. Pieces whose uv is mirrored are mirrored back, so that
// their cloth shows its face. Errors: std::runtime_error "NAME: ..." with one line for a mesh without uv, triangles
// without area in space or in uv, or a piece that is mirrored in part.
ClothSurface cloth_surface(const UvMesh& mesh, const UvPlacement& placement, const Eigen::Isometry3d& world_from_mesh,
                           const std::string& name);

// The mesh as a matt body.
TriangleMesh body(const UvMesh& mesh, double unit_mm, const Eigen::Isometry3d& world_from_mesh,
                  const cv::Vec3f& albedo);

}  // namespace renderer
