#include "renderer/scene/mesh_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <map>
#include <string>

namespace renderer {
namespace {

namespace fs = std::filesystem;

// A right triangle with uv, in each format; made by hand. glTF counts v downwards.
const std::map<std::string, std::string> kTriangles{
    {"t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"},
    {"t.ply",
     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
     "property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
     "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"},
    {"t.gltf",
     R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
     R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2}]}],)"
     R"("buffers":[{"byteLength":68,"uri":"data:application/octet-stream;base64,)"
     R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAIA/AACAPwAAAAAAAAAAAAABAAIAAAA="}],)"
     R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},)"
     R"({"buffer":0,"byteOffset":60,"byteLength":6}],)"
     R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},)"
     R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},)"
     R"({"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}]})"}};

class MeshFileTest : public ::testing::Test {
 protected:
  MeshFileTest() { fs::create_directories(folder_); }
  ~MeshFileTest() override { fs::remove_all(folder_); }
  fs::path written(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::string refusal(const std::string& name, const std::string& text) const {
    try {
      read_mesh(written(name, text));
    } catch (const std::runtime_error& problem) {
      return problem.what();
    }
    return {};
  }
  const fs::path folder_ = fs::temp_directory_path() / ("threadstation-mesh-" + std::to_string(::getpid()));
};

TEST_F(MeshFileTest, ATriangleIsTheSameInEachFormat) {
  for (const auto& [name, text] : kTriangles) {
    const UvMesh mesh = read_mesh(written(name, text));
    ASSERT_EQ(mesh.triangles.size(), 1U) << name;
    ASSERT_EQ(mesh.vertices.size(), 3U) << name;
    ASSERT_EQ(mesh.uv.size(), 3U) << name;
    const auto& t = mesh.triangles[0];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& at = mesh.vertices[t[static_cast<std::size_t>(k)]];
      EXPECT_NEAR((at - mesh.vertices[t[0]] - Eigen::Vector3d(k == 1, k == 2, 0)).norm(), 0, 1e-6) << name;
      // uv says the same as x and y here, with (0, 0) lower left whatever the format's own habit is.
      EXPECT_NEAR((mesh.uv[t[static_cast<std::size_t>(k)]] - Eigen::Vector2d(k == 1, k == 2)).norm(), 0, 1e-6)
          << name << " corner " << k << ": " << mesh.uv[t[static_cast<std::size_t>(k)]].transpose();
    }
  }
}

TEST_F(MeshFileTest, PolygonsBecomeTrianglesAndUvMayBeMissing) {
  const UvMesh mesh = read_mesh(written("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nl 1 3\n"));
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_TRUE(mesh.uv.empty());
}

TEST_F(MeshFileTest, WhatIsNoMeshGetsOneLine) {
  EXPECT_NE(refusal("empty.obj", "").find("empty.obj: "), std::string::npos);
  EXPECT_NE(refusal("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n").find("points.obj: "), std::string::npos);
  EXPECT_NE(refusal("a.stl", "solid\n").find("expected .obj, .ply, .gltf or .glb"), std::string::npos);
  EXPECT_NE(refusal("rubbish.ply", std::string(2000, '\xff')).find("is no PLY mesh or is cut short"),
            std::string::npos);
  EXPECT_THROW(read_mesh(folder_ / "none.obj"), std::runtime_error);
  EXPECT_NE(refusal("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").find("not numbers"), std::string::npos);
}

// A file that stopped growing at any byte is read as less or refused in one line.
TEST_F(MeshFileTest, CutShortItIsRefusedOrLess) {
  for (const auto& [name, text] : kTriangles)
    for (std::size_t bytes = 0; bytes < text.size(); ++bytes) {
      const std::string said = refusal(name, text.substr(0, bytes));
      EXPECT_EQ(said.find('\n'), std::string::npos) << name << " of " << bytes << " bytes: " << said;
    }
}

}  // namespace
}  // namespace renderer
