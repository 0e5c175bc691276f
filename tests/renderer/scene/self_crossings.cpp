#include "tests/renderer/scene/self_crossings.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>
#include <vector>

namespace renderer {
namespace {

using Eigen::Vector3d;
using Cell = std::array<int, 3>;

Cell cell_of(const Vector3d& at, double size_mm) {
  return {static_cast<int>(std::floor(at.x() / size_mm)), static_cast<int>(std::floor(at.y() / size_mm)),
          static_cast<int>(std::floor(at.z() / size_mm))};
}

std::uint64_t key_of(const Cell& cell) {
  std::uint64_t key = 0;
  for (const int one : cell) key = key << 21 | static_cast<std::uint64_t>(one + (1 << 20));
  return key;
}

template <class Use>
void each_cell(const Vector3d& low, const Vector3d& high, double size_mm, const Use& use) {
  const Cell first = cell_of(low, size_mm), last = cell_of(high, size_mm);
  for (int x = first[0]; x <= last[0]; ++x)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int z = first[2]; z <= last[2]; ++z) use(key_of({x, y, z}));
}

bool pierces(const Vector3d& from, const Vector3d& to, const std::array<Vector3d, 3>& corners) {
  const auto volume = [](const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    return (b - a).cross(c - a).dot(d - a);
  };
  const auto& [a, b, c] = corners;
  if (volume(a, b, c, from) * volume(a, b, c, to) >= 0) return false;
  const double x = volume(from, to, a, b), y = volume(from, to, b, c), z = volume(from, to, c, a);
  return (x > 0 && y > 0 && z > 0) || (x < 0 && y < 0 && z < 0);
}

}  // namespace

int self_crossings(const UvMesh& mesh) {
  double longest_mm = 0;
  std::set<std::array<std::uint32_t, 2>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      edges.insert({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
      longest_mm = std::max(longest_mm, (mesh.vertices[t[k]] - mesh.vertices[t[(k + 1) % 3]]).norm());
    }
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> triangles;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    each_cell(mesh.vertices[a].cwiseMin(mesh.vertices[b]).cwiseMin(mesh.vertices[c]),
              mesh.vertices[a].cwiseMax(mesh.vertices[b]).cwiseMax(mesh.vertices[c]), longest_mm,
              [&](std::uint64_t key) { triangles[key].push_back(i); });
  }
  int crossings = 0;
  for (const auto& [from, to] : edges) {
    const Vector3d &a = mesh.vertices[from], &b = mesh.vertices[to];
    std::set<std::uint32_t> pierced;  // a triangle may lie in several cells
    each_cell(a.cwiseMin(b), a.cwiseMax(b), longest_mm, [&](std::uint64_t key) {
      const auto near = triangles.find(key);
      if (near == triangles.end()) return;
      for (const std::uint32_t i : near->second) {
        const auto& t = mesh.triangles[i];
        // A seam has two vertices in one place.
        const bool touches =
            std::ranges::any_of(t, [&](std::uint32_t v) { return mesh.vertices[v] == a || mesh.vertices[v] == b; });
        if (!touches && pierces(a, b, {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}))
          pierced.insert(i);
      }
    });
    crossings += static_cast<int>(pierced.size());
  }
  return crossings;
}

}  // namespace renderer
