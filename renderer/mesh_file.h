// Triangle meshes that other programs write: OBJ, PLY and glTF (.gltf, .glb), through libassimp. The only place that
// knows it.
#pragma once

#include <filesystem>

#include "renderer/uv_mesh.h"

namespace renderer {

inline constexpr std::size_t kMostMeshTriangles = 5'000'000;  // about 4 GB as cloth

// All meshes of a file in one frame, in the file's unit; polygons are cut into triangles. uv is empty when some mesh of the
// file has none. Normals of the file are not read (uv_mesh.h).
// Errors: std::runtime_error with one line: no such file, another ending, cut short or not that format, no triangles, too
// many, coordinates that are no numbers.
UvMesh read_mesh(const std::filesystem::path& file);

}  // namespace renderer
