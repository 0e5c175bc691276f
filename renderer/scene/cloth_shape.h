// Shapes that cloth and bodies take, and cloth as explicit curves on the simple ones.
//
// Each shape lies in a frame of its own (mm). Patch coordinates are millimetres on the shape, so threads keep their
// size.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "renderer/scene/scene.h"
#include "renderer/scene/uv_mesh.h"

namespace renderer {

// A flat swatch: [-width / 2, width / 2] x [-height / 2, height / 2] at z = 0, the face towards +z, the weft along x.
// The patch starts at the lower left corner.
struct SwatchShape {
  double width_mm = 100.0, height_mm = 100.0;
};

// A tube round the z axis from z = 0 to the height, open at both ends, the face outwards, the weft around it. The patch
// is stretched round it by at most half a period, so that a whole number of periods closes it without a seam.
struct CylinderShape {
  double radius_mm = 41.0, height_mm = 171.0;
};

// A garment, ready (garment.h) or from a file (mesh_file.h).
struct MeshShape {
  std::shared_ptr<const UvMesh> mesh{};
  UvPlacement placement{};
  std::string name{};  // of the file, for messages
};

using ClothShape = std::variant<SwatchShape, CylinderShape, MeshShape>;

// The surface of cloth on the shape. Errors: std::runtime_error with one line when a tube is narrower than half a
// period of the patch; those of cloth_surface.
ClothSurface surface_of(const ClothShape& shape, const YarnPatch& patch, const Eigen::Isometry3d& world_from_cloth);

// The same cloth as curves, one set for each thread and section that occur, cut off at the borders of the shape as the
// surface is. Yarns bend smoothly on a cylinder and keep their round cross-section. Errors: those of surface_of, and
// std::runtime_error for a mesh, which has no explicit curves, for flattened yarns on a cylinder, for a thread that is
// not among `threads`, and for more than `kMostExplicitSegments` segments.
inline constexpr double kMostExplicitSegments = 2e7;  // about 4 GB with Embree's tree
std::vector<CurveSet> explicit_curves(const ClothShape& shape, const YarnPatch& patch,
                                      const std::vector<ScatteringModel>& threads,
                                      const Eigen::Isometry3d& world_from_cloth);

// The shape as a diffuse surface; a cylinder is open at both ends.
TriangleMesh body_of(const ClothShape& shape, const Eigen::Isometry3d& world_from_body, const cv::Vec3f& albedo);

}  // namespace renderer
