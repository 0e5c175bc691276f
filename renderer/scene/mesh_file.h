// Triangle meshes that other programs write: OBJ, PLY and glTF (.gltf, .glb), through libassimp, which is met only
// here.
#pragma once

#include <filesystem>

#include "renderer/scene/uv_mesh.h"

namespace renderer {

inline constexpr std::size_t kMostMeshTriangles = 5'000'000;  // about 4 GB as cloth

// All meshes of a file in one frame, in the file's unit; polygons are cut into triangles. uv is empty when some mesh of
// the file has none. Normals of the file are not read (uv_mesh.h). Errors: std::runtime_error with one line when there
// is no such file, its ending is another, it is cut short or not of that format, has no triangles or too many, or has
// coordinates that are no numbers.
UvMesh read_mesh(const std::filesystem::path& file);

}  // namespace renderer
