#include "renderer/trace/cloth_shell.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>
#include <string>

namespace renderer {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Triangle = std::array<std::uint32_t, 3>;

[[noreturn]] void refuse(std::size_t triangle, const std::string& problem) {
  throw std::runtime_error("cloth surface: triangle " + std::to_string(triangle) + " " + problem);
}

void check(const ClothSurface& surface) {
  const std::size_t count = surface.vertices.size();
  if (surface.normals.size() != count || surface.patch_mm.size() != count)
    throw std::runtime_error("cloth surface: " + std::to_string(count) + " vertices, but " +
                             std::to_string(surface.normals.size()) + " normals and " +
                             std::to_string(surface.patch_mm.size()) + " places in the patch; give one for each");
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    for (const std::uint32_t corner : surface.triangles[i])
      if (corner >= count) refuse(i, "names vertex " + std::to_string(corner) + ", which does not exist");
}

// The direction on the surface in which the patch's x grows, times twice the triangle's area.
Vector3d patch_x_direction(const ClothSurface& surface, const Triangle& t) {
  const Vector3d e1 = surface.vertices[t[1]] - surface.vertices[t[0]],
                 e2 = surface.vertices[t[2]] - surface.vertices[t[0]];
  const Eigen::Vector2d p1 = surface.patch_mm[t[1]] - surface.patch_mm[t[0]],
                        p2 = surface.patch_mm[t[2]] - surface.patch_mm[t[0]];
  return (p2.y() * e1 - p1.y() * e2).normalized() * e1.cross(e2).norm();
}

// The frame whose columns are x (the part of `along` that is perpendicular to the normal), y and the unit normal.
Matrix3d frame_of(const Vector3d& along, const Vector3d& normal) {
  Matrix3d frame;
  frame.col(2) = normal.normalized();
  frame.col(0) = (along - along.dot(frame.col(2)) * frame.col(2)).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

std::vector<Matrix3d> vertex_frames(const ClothSurface& surface) {
  std::vector<Vector3d> along(surface.vertices.size(), Vector3d::Zero());
  for (const Triangle& triangle : surface.triangles)
    for (const std::uint32_t corner : triangle) along[corner] += patch_x_direction(surface, triangle);
  std::vector<Matrix3d> frames;
  for (std::size_t i = 0; i < along.size(); ++i) frames.push_back(frame_of(along[i], surface.normals[i]));
  return frames;
}

struct Corner {
  std::uint32_t vertex;
  double height_mm;
};

// The tetrahedron of four corners, with the affine map that takes them from the world to their places in the patch, and
// with their barycentric weights.
ShellCell make_cell(const ClothSurface& surface, const std::array<Corner, 4>& corners, std::size_t triangle) {
  Eigen::Matrix4d world, patch;  // homogeneous, one column per corner
  ShellCell cell;
  for (int k = 0; k < 4; ++k) {
    const auto& [vertex, height] = corners[static_cast<std::size_t>(k)];
    const Vector3d position = surface.vertices[vertex] + height * surface.normals[vertex].normalized();
    world.col(k) << position, 1;
    patch.col(k) << surface.patch_mm[vertex], height, 1;
    cell.vertex[static_cast<std::size_t>(k)] = vertex;
    cell.bounds.extend(position);
  }
  const double size_patch = patch.determinant(), size_world = world.determinant();
  constexpr double kLeast = 1e-6;  // of the patch's volume; a surface may be stretched, not folded
  if (!(std::abs(size_patch) > 0)) refuse(triangle, "has no area in the patch; give its corners different places");
  if (!(size_world / size_patch > kLeast))
    refuse(triangle,
           "turns the wrong way round in the patch, or the surface bends more sharply than the cloth is thick; check "
           "normals and order of corners, or take a smoother surface");
  cell.inside_from_world.topRows<4>() = world.inverse();
  cell.patch_from_world = patch.topRows<3>() * cell.inside_from_world.topRows<4>();
  return cell;
}

// Turns the tetrahedron a, b, c, over_c into the whole prism: c's weight takes in that of over_c, which is the height.
ShellCell whole_prism(ShellCell cell, const ClothSurface& surface, const Triangle& v, const SurfaceRange& heights) {
  cell.faces = 5, cell.corners = 3;
  cell.inside_from_world.row(2) += cell.inside_from_world.row(3);
  cell.inside_from_world.row(4) = Eigen::RowVector4d::UnitW() - cell.inside_from_world.row(3);
  for (const std::uint32_t vertex : v)
    cell.bounds.extend(surface.vertices[vertex] + heights.high_mm * surface.normals[vertex].normalized());
  return cell;
}

bool is_flat(const ClothSurface& surface, const Triangle& v) {
  constexpr double kParallel = 1e-12;
  const Vector3d a = surface.normals[v[0]].normalized();
  return (surface.normals[v[1]].normalized() - a).norm() < kParallel &&
         (surface.normals[v[2]].normalized() - a).norm() < kParallel;
}

// The range of spreads in which yarns keep their thickness; beyond it they are stretched with the surface.
constexpr double kLeastSpread = 0.7, kMostSpread = 1.5;

// The lengths of the patch's x and y in the world, as far as yarns follow them.
Eigen::Array2d lengths_of_xy(const ShellCell& cell) {
  return world_from_patch(cell).leftCols<2>().colwise().norm().transpose().array().max(kLeastSpread).min(kMostSpread);
}

// Rounding is no spread: flat cloth is met as quickly as can be.
Eigen::Vector2f exactly_one_where_nearly(const Eigen::Array2d& lengths) {
  return ((lengths - 1).abs() < 1e-6).select(1, lengths).cast<float>();
}

// From the spreads at two heights.
Spread spread_of(const Eigen::Array2d& below, double below_mm, const Eigen::Array2d& above, double above_mm) {
  const Eigen::Array2d growth = (above - below) / (above_mm - below_mm);
  return {.middle = (below - below_mm * growth).cast<float>(), .growth = growth.cast<float>()};
}

}  // namespace

Affine3x4 world_from_patch(const ShellCell& cell) {
  Affine3x4 inverse;
  inverse.leftCols<3>() = cell.patch_from_world.leftCols<3>().inverse();
  inverse.col(3) = -inverse.leftCols<3>() * cell.patch_from_world.col(3);
  return inverse;
}

ClothShell make_shell(const ClothSurface& surface, const SurfaceRange& heights) {
  check(surface);
  ClothShell shell{.cells = {}, .frames = vertex_frames(surface)};
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    // Corners are sorted by place, so that the diagonal of a side face goes from the first corner's bottom to the
    // second one's top in both prisms beside it, across a seam too, where one place has two vertices.
    Triangle v = surface.triangles[i];
    std::ranges::sort(v, [&](std::uint32_t a, std::uint32_t b) {
      const Vector3d &p = surface.vertices[a], &q = surface.vertices[b];
      return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
    });
    const Corner a{v[0], heights.low_mm}, b{v[1], heights.low_mm}, c{v[2], heights.low_mm};
    const Corner over_a{v[0], heights.high_mm}, over_b{v[1], heights.high_mm}, over_c{v[2], heights.high_mm};
    shell.cells.push_back(make_cell(surface, {a, b, c, over_c}, i));
    if (is_flat(surface, v)) {
      shell.cells.back() = whole_prism(shell.cells.back(), surface, v, heights);
      shell.cells.back().spread.middle = exactly_one_where_nearly(lengths_of_xy(shell.cells.back()));
      continue;
    }
    shell.cells.push_back(make_cell(surface, {a, b, over_b, over_c}, i));
    shell.cells.push_back(make_cell(surface, {a, over_a, over_b, over_c}, i));
    const Spread spread = spread_of(lengths_of_xy(shell.cells.end()[-3]), heights.low_mm,
                                    lengths_of_xy(shell.cells.back()), heights.high_mm);
    for (int k = 1; k <= 3; ++k) shell.cells.end()[-k].spread = spread;
  }
  for (const ShellCell& cell : shell.cells)
    for (const double height_mm : {heights.low_mm, heights.high_mm})
      shell.least_spread = std::min(
          shell.least_spread, (cell.spread.middle + static_cast<float>(height_mm) * cell.spread.growth).minCoeff());
  return shell;
}

std::optional<RaySpan> clip(const ShellCell& cell, const Vector3d& origin, const Vector3d& direction, RaySpan within) {
  using FaceDistances = Eigen::Matrix<double, 5, 1>;
  const FaceDistances start = cell.inside_from_world * origin.homogeneous();
  const FaceDistances slope = cell.inside_from_world.leftCols<3>() * direction;
  for (int k = 0; k < cell.faces; ++k) {
    const double crossing = -start[k] / slope[k];
    if (slope[k] > 0)
      within.begin = std::max(within.begin, crossing - kShellOverlap);
    else if (slope[k] < 0)
      within.end = std::min(within.end, crossing + kShellOverlap);
    else if (start[k] < 0)
      return std::nullopt;
    if (!(within.begin <= within.end)) return std::nullopt;
  }
  return within;
}

Matrix3d frame_at(const ClothShell& shell, const ShellCell& cell, const Vector3d& world) {
  const Eigen::Matrix<double, 5, 1> weights = cell.inside_from_world * world.homogeneous();
  Vector3d along = Vector3d::Zero(), normal = Vector3d::Zero();
  for (int k = 0; k < cell.corners; ++k) {
    const Matrix3d& frame = shell.frames[cell.vertex[static_cast<std::size_t>(k)]];
    along += weights[k] * frame.col(0);
    normal += weights[k] * frame.col(2);
  }
  return frame_of(along, normal);
}

}  // namespace renderer
