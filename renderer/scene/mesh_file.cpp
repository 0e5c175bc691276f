#include "renderer/scene/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

namespace renderer {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& problem) {
  throw std::runtime_error(file.string() + ": " + problem);
}

// libassimp 5.2 reads on for ever in a PLY file whose header does not end.
void check_header(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  constexpr int kMostLines = 1000;
  std::string line;
  for (int lines = 0; lines < kMostLines && std::getline(stream, line); ++lines)
    if (line.substr(0, line.find_last_not_of(" \t\r") + 1) == "end_header") return;
  refuse(file, "is no PLY mesh or is cut short: its header has no end; export it again");
}

bool is_whole(const aiScene& scene) {
  const auto whole = [](const aiMesh* mesh) {
    return mesh->mNumVertices > 0 && mesh->mVertices &&
           std::ranges::all_of(std::span(mesh->mFaces, mesh->mNumFaces), [&](const aiFace& face) {
             return face.mNumIndices > 0 &&
                    std::ranges::all_of(std::span(face.mIndices, face.mNumIndices),
                                        [&](unsigned corner) { return corner < mesh->mNumVertices; });
           });
  };
  return (scene.mFlags & AI_SCENE_FLAGS_INCOMPLETE) == 0 &&
         std::ranges::all_of(std::span(scene.mMeshes, scene.mNumMeshes), whole);
}

void append(const aiMesh& mesh, bool with_uv, UvMesh& whole) {
  const auto first = static_cast<std::uint32_t>(whole.vertices.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& p = mesh.mVertices[i];
    whole.vertices.emplace_back(p.x, p.y, p.z);
    if (with_uv) whole.uv.emplace_back(mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y);
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const unsigned* corner = mesh.mFaces[i].mIndices;
    whole.triangles.push_back({first + corner[0], first + corner[1], first + corner[2]});
  }
}

void check(const UvMesh& mesh, const fs::path& file) {
  if (mesh.triangles.empty()) refuse(file, "has no triangles; export the surface as a mesh");
  if (mesh.triangles.size() > kMostMeshTriangles)
    refuse(file, "has " + std::to_string(mesh.triangles.size()) + " triangles, at most " +
                     std::to_string(kMostMeshTriangles) + " are drawn; reduce the mesh");
  const auto number = [](const auto& v) { return v.allFinite(); };
  if (!std::ranges::all_of(mesh.vertices, number) || !std::ranges::all_of(mesh.uv, number))
    refuse(file, "has coordinates that are not numbers; export it again");
}

}  // namespace

UvMesh read_mesh(const fs::path& file) {
  if (!fs::is_regular_file(file)) refuse(file, "no such file; name an OBJ, PLY or glTF mesh");
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array kEndings{".obj", ".ply", ".gltf", ".glb"};
  if (std::ranges::find(kEndings, ending) == kEndings.end())
    refuse(file, "found the ending \"" + ending + "\", expected .obj, .ply, .gltf or .glb");
  if (ending == ".ply") check_header(file);
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const auto failed = [&]() -> std::string {
    std::string said = importer.GetErrorString();
    std::ranges::replace(said, '\n', ' ');
    return said.empty() ? "it is cut short" : said;
  };
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_ValidateDataStructure);
  // Later steps of libassimp end the program where a face has lost its corners.
  if (scene && is_whole(*scene))
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType |
                                         aiProcess_PreTransformVertices |  // the meshes of all nodes in one frame
                                         aiProcess_JoinIdenticalVertices);
  else
    scene = nullptr;
  if (!scene) refuse(file, "cannot be read as a mesh (" + failed() + "); export it again");
  UvMesh mesh;
  const std::span<aiMesh* const> parts(scene->mMeshes, scene->mNumMeshes);
  const bool with_uv = std::ranges::all_of(parts, [](const aiMesh* part) { return part->HasTextureCoords(0); });
  for (const aiMesh* part : parts)
    if ((part->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0) append(*part, with_uv, mesh);
  check(mesh, file);
  return mesh;
}

}  // namespace renderer
