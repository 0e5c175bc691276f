#include "renderer/scene/uv_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

namespace renderer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Triangle = std::array<std::uint32_t, 3>;

[[noreturn]] void refuse(const std::string& name, const std::string& problem) {
  throw std::runtime_error(name + ": " + problem);
}

Vector3d area_vector(const UvMesh& mesh, const Triangle& t) {
  const Vector3d a = mesh.vertices[t[1]] - mesh.vertices[t[0]], b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
  return a.cross(b) / 2;
}

double uv_area(const UvMesh& mesh, const Triangle& t) {
  const Vector2d a = mesh.uv[t[1]] - mesh.uv[t[0]], b = mesh.uv[t[2]] - mesh.uv[t[0]];
  return (a.x() * b.y() - a.y() * b.x()) / 2;
}

void check(const UvMesh& mesh, const std::string& name) {
  if (mesh.uv.size() != mesh.vertices.size())
    refuse(name, "has no uv coordinates, which say where each place of the cloth was cut from; unwrap the mesh");
  std::size_t flat = 0, pointlike = 0;
  constexpr double kLeast = 1e-12;  // of the square of the longest edge
  for (const Triangle& t : mesh.triangles) {
    double edge2 = 0, uv_edge2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      edge2 = std::max(edge2, (mesh.vertices[t[k]] - mesh.vertices[t[(k + 1) % 3]]).squaredNorm());
      uv_edge2 = std::max(uv_edge2, (mesh.uv[t[k]] - mesh.uv[t[(k + 1) % 3]]).squaredNorm());
    }
    flat += !(area_vector(mesh, t).norm() > kLeast * edge2);
    pointlike += !(std::abs(uv_area(mesh, t)) > kLeast * uv_edge2);
  }
  const std::string of = " of " + std::to_string(mesh.triangles.size()) + " triangles";
  if (flat > 0) refuse(name, std::to_string(flat) + of + " have no area; remove them from the mesh");
  if (pointlike > 0)
    refuse(name, std::to_string(pointlike) + of + " have no area in uv; unwrap the mesh so that each has its place");
}

// For each vertex the first vertex at the same place.
std::vector<std::uint32_t> welded(const UvMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b];
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  };
  std::ranges::stable_sort(order, before);
  std::vector<std::uint32_t> first(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && mesh.vertices[order[i]] == mesh.vertices[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

double angle_at(const UvMesh& mesh, const Triangle& t, std::size_t corner) {
  const Vector3d& p = mesh.vertices[t[corner]];
  const Vector3d a = mesh.vertices[t[(corner + 1) % 3]] - p, b = mesh.vertices[t[(corner + 2) % 3]] - p;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// The unit normals; a place where the triangles' normals cancel has that of its first triangle.
std::vector<Vector3d> normals_of(const UvMesh& mesh) {
  const std::vector<std::uint32_t> place = welded(mesh);
  std::vector<Vector3d> sums(mesh.vertices.size(), Vector3d::Zero()), firsts = sums;
  for (const Triangle& t : mesh.triangles) {
    const Vector3d normal = area_vector(mesh, t).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      sums[place[t[k]]] += angle_at(mesh, t, k) * normal;
      if (firsts[place[t[k]]].isZero()) firsts[place[t[k]]] = normal;
    }
  }
  std::vector<Vector3d> normals;
  for (const std::uint32_t p : place) {
    const Vector3d& sum = sums[p];
    normals.push_back(sum.norm() > 1e-3 ? sum.normalized() : firsts[p].isZero() ? Vector3d::UnitZ() : firsts[p]);
  }
  return normals;
}

// The number of each vertex's piece; triangles that share a vertex belong to one piece.
std::vector<std::uint32_t> pieces_of(const UvMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) parent[root(t[1])] = parent[root(t[2])] = root(t[0]);
  for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = root(v);
  return parent;
}

// True for the vertices of mirrored pieces.
std::vector<bool> mirrored_vertices(const UvMesh& mesh, const std::string& name) {
  const std::vector<std::uint32_t> piece = pieces_of(mesh);
  std::map<std::uint32_t, std::array<std::size_t, 2>> turns;  // triangles of each piece by their sense in uv
  for (const Triangle& t : mesh.triangles) ++turns[piece[t[0]]][uv_area(mesh, t) < 0];
  for (const auto& [which, count] : turns)
    if (count[0] > 0 && count[1] > 0)
      refuse(name, std::to_string(std::min(count[0], count[1])) + " triangles of a piece of " +
                       std::to_string(count[0] + count[1]) + " lie upside down in uv; unwrap the mesh without folds");
  std::vector<bool> mirrored;
  for (const std::uint32_t p : piece) mirrored.push_back(turns.contains(p) && turns.at(p)[1] > 0);
  return mirrored;
}

double measured_uv_mm(const UvMesh& mesh, double unit_mm) {
  double area = 0, in_uv = 0;
  for (const Triangle& t : mesh.triangles) {
    area += area_vector(mesh, t).norm();
    in_uv += std::abs(uv_area(mesh, t));
  }
  return unit_mm * std::sqrt(area / in_uv);
}

}  // namespace

ClothSurface cloth_surface(const UvMesh& mesh, const UvPlacement& placement, const Eigen::Isometry3d& world_from_mesh,
                           const std::string& name) {
  check(mesh, name);
  const std::vector<bool> mirrored = mirrored_vertices(mesh, name);
  const double uv_mm = placement.uv_mm > 0 ? placement.uv_mm : measured_uv_mm(mesh, placement.unit_mm);
  const Eigen::Rotation2Dd cloth_from_pattern(-placement.turn_rad);
  ClothSurface surface{.normals = normals_of(mesh), .triangles = mesh.triangles};
  for (Vector3d& normal : surface.normals) normal = world_from_mesh.linear() * normal;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    surface.vertices.push_back(world_from_mesh * Vector3d(placement.unit_mm * mesh.vertices[i]));
    const Vector2d uv(mirrored[i] ? -mesh.uv[i].x() : mesh.uv[i].x(), mesh.uv[i].y());
    surface.patch_mm.push_back(cloth_from_pattern * (uv_mm * uv));
  }
  return surface;
}

TriangleMesh body(const UvMesh& mesh, double unit_mm, const Eigen::Isometry3d& world_from_mesh,
                  const cv::Vec3f& albedo) {
  TriangleMesh made{.triangles = mesh.triangles, .albedo = cv::Mat3f(1, 1, albedo)};
  for (const Vector3d& vertex : mesh.vertices)
    made.vertices.push_back((world_from_mesh * Vector3d(unit_mm * vertex)).cast<float>());
  return made;
}

}  // namespace renderer
