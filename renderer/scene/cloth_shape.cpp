#include "renderer/scene/cloth_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>

#include "renderer/scene/grid_triangles.h"
#include "renderer/scene/patch_curves.h"

namespace renderer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kCellPeriods =
    8;  // periods along a side of a flat quad: its boxes are then about as flat as the cloth
constexpr double kBendRad = 0.0246;  // between neighbouring facets of a cylinder: 256 facets
constexpr int kMostQuads = 512;      // along one side

int quads_along(double length_mm, double period_mm) {
  return std::clamp(static_cast<int>(std::ceil(length_mm / (kCellPeriods * period_mm))), 1, kMostQuads);
}

// A grid of columns x rows quads; point(u, v) with u, v in [0, 1] appends one vertex.
template <class Surface, class Point>
void add_grid(Surface& surface, int columns, int rows, const Point& point) {
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column) point(column, row);
  surface.triangles = grid_triangles(columns, rows);
}

int periods_around(const CylinderShape& cylinder, const YarnPatch& patch) {
  const double around_mm = 2 * std::numbers::pi * cylinder.radius_mm;
  const int periods = static_cast<int>(std::lround(around_mm / patch.period_x_mm));
  if (periods < 1)
    throw std::runtime_error("cloth: a tube of " + std::to_string(around_mm) + " mm around cannot hold one repeat of " +
                             std::to_string(patch.period_x_mm) + " mm; take a wider tube or a smaller draft");
  return periods;
}

Vector3d outwards(double angle_rad) {
  return {std::cos(angle_rad), std::sin(angle_rad), 0};
}

int facets_around() {
  return static_cast<int>(std::ceil(2 * std::numbers::pi / kBendRad));
}

// The angle at which a column of facets begins; the last one ends exactly where the first one begins.
double facet_angle(int column, int facets) {
  return 2 * std::numbers::pi * (column % facets) / facets;
}

struct SurfaceBuilder {
  const YarnPatch& patch;
  const Eigen::Isometry3d& world_from_cloth;

  ClothSurface operator()(const SwatchShape& s) const {
    ClothSurface surface;
    const int columns = quads_along(s.width_mm, patch.period_x_mm), rows = quads_along(s.height_mm, patch.period_y_mm);
    add_grid(surface, columns, rows, [&](int column, int row) {
      const double x = s.width_mm * column / columns, y = s.height_mm * row / rows;
      surface.vertices.push_back(world_from_cloth * Vector3d(x - s.width_mm / 2, y - s.height_mm / 2, 0));
      surface.normals.push_back(world_from_cloth.linear().col(2));
      surface.patch_mm.push_back({x, y});
    });
    return surface;
  }

  ClothSurface operator()(const CylinderShape& s) const {
    ClothSurface surface;
    const int facets = facets_around(), rows = quads_along(s.height_mm, patch.period_y_mm);
    const double around_mm = periods_around(s, patch) * patch.period_x_mm;
    add_grid(surface, facets, rows, [&](int column, int row) {
      const double z = s.height_mm * row / rows;
      const Vector3d normal = outwards(facet_angle(column, facets));
      surface.vertices.push_back(world_from_cloth * (s.radius_mm * normal + Vector3d(0, 0, z)));
      surface.normals.push_back(world_from_cloth.linear() * normal);
      surface.patch_mm.push_back({around_mm * column / facets, z});
    });
    return surface;
  }

  ClothSurface operator()(const MeshShape& s) const {
    return cloth_surface(*s.mesh, s.placement, world_from_cloth, s.name);
  }
};

// The tiles that cover the shape.
Tiles tiles_of(const ClothShape& shape, const YarnPatch& patch) {
  const auto whole = [](double length, double period) {
    return std::max(1, static_cast<int>(std::ceil(length / period - 1e-9)));
  };
  if (const auto* s = std::get_if<SwatchShape>(&shape))
    return {whole(s->width_mm, patch.period_x_mm), whole(s->height_mm, patch.period_y_mm)};
  const auto& s = std::get<CylinderShape>(shape);
  return {periods_around(s, patch), whole(s.height_mm, patch.period_y_mm)};
}

Vector3d on_shape(const ClothShape& shape, double around_mm, const Vector3d& sheet) {
  if (const auto* s = std::get_if<SwatchShape>(&shape)) return sheet - Vector3d(s->width_mm / 2, s->height_mm / 2, 0);
  const auto& s = std::get<CylinderShape>(shape);
  return (s.radius_mm + sheet.z()) * outwards(2 * std::numbers::pi * sheet.x() / around_mm) + Vector3d(0, 0, sheet.y());
}

// The planes at the borders of the shape (CurveSet::cut), in a sheet whose x and y are `stretch` times as long there.
std::vector<Eigen::Vector4f> borders_of(const ClothShape& shape, const Vector3d& stretch) {
  if (const auto* s = std::get_if<SwatchShape>(&shape)) {
    const auto width = static_cast<float>(s->width_mm / stretch.x()),
               height = static_cast<float>(s->height_mm / stretch.y());
    return {{-1, 0, 0, 0}, {1, 0, 0, width}, {0, -1, 0, 0}, {0, 1, 0, height}};
  }
  const auto height = static_cast<float>(std::get<CylinderShape>(shape).height_mm);
  return {{0, 0, -1, 0}, {0, 0, 1, height}};
}

Eigen::Vector4f moved(const Eigen::Vector4f& plane, const Eigen::Isometry3d& by) {
  const Vector3d normal = by.linear() * plane.head<3>().cast<double>();
  Eigen::Vector4f result;
  result << normal.cast<float>(), plane.w() + static_cast<float>(normal.dot(by.translation()));
  return result;
}

// Leaves out the segments of which nothing is left after the cut.
void drop_what_is_cut_off(CurveSet& set) {
  std::erase_if(set.segments, [&](std::uint32_t first) {
    const std::span points(&set.control_points[first], 4);
    return std::ranges::any_of(set.cut, [&](const Eigen::Vector4f& plane) {
      return std::ranges::all_of(points, [&](const Eigen::Vector4f& point) {
        return plane.head<3>().dot(point.head<3>()) - point.w() > plane.w();
      });
    });
  });
}

double segments_of(const YarnPatch& patch, const Tiles& tiles) {
  double segments = 0;
  for (const Yarn& yarn : patch.yarns) segments += static_cast<double>(yarn.control_points.size());
  return segments * tiles.x * tiles.y;
}

}  // namespace

ClothSurface surface_of(const ClothShape& shape, const YarnPatch& patch, const Eigen::Isometry3d& world_from_cloth) {
  return std::visit(SurfaceBuilder{patch, world_from_cloth}, shape);
}

std::vector<CurveSet> explicit_curves(const ClothShape& shape, const YarnPatch& patch,
                                      const std::vector<ScatteringModel>& threads,
                                      const Eigen::Isometry3d& world_from_cloth) {
  if (const auto* mesh = std::get_if<MeshShape>(&shape))
    throw std::runtime_error(mesh->name + ": brute force lays yarns on swatches and cylinders only; use two_scale");
  const Tiles tiles = tiles_of(shape, patch);
  if (!(segments_of(patch, tiles) <= kMostExplicitSegments))
    throw std::runtime_error("cloth: brute force would need " + std::to_string(tiles.x) + " x " +
                             std::to_string(tiles.y) + " repeats of \"" + patch.name +
                             "\" as curves, more than memory should hold; use two_scale or a smaller cloth");
  check_cloth(patch, threads.size());
  const auto* swatch = std::get_if<SwatchShape>(&shape);
  const double around_mm = tiles.x * patch.period_x_mm;
  // The sheet of a swatch begins at its corner.
  const Eigen::Isometry3d world_from_sheet =
      swatch ? world_from_cloth * Eigen::Translation3d(on_shape(shape, around_mm, Vector3d::Zero())) : world_from_cloth;
  std::vector<CurveSet> sets;
  for (const RoundYarns& part : round_yarns_of(patch)) {
    const bool round = part.stretch == Vector3d::Ones();
    if (!round && !swatch)
      throw std::runtime_error("cloth: \"" + patch.name +
                               "\" has flattened yarns, and brute force bends round ones only; use two_scale");
    const Tiles all = with_neighbours(part.patch, tiles, swatch != nullptr);  // a tube closes along x
    for (const int thread : threads_of(part.patch)) {
      CurveSet set = curves_of(part.patch, all, thread);
      set.scattering = threads[static_cast<std::size_t>(thread)];
      set.cut = borders_of(shape, part.stretch);
      if (round) {
        for (Eigen::Vector4f& plane : set.cut) plane = moved(plane, world_from_sheet);
        for (Eigen::Vector4f& point : set.control_points) {
          const Vector3d sheet = point.head<3>().cast<double>();
          point.head<3>() = (world_from_cloth * on_shape(shape, around_mm, sheet)).cast<float>();
        }
      } else {
        set.placed = (world_from_sheet * Eigen::Scaling(part.stretch)).cast<float>();
      }
      drop_what_is_cut_off(set);
      sets.push_back(std::move(set));
    }
  }
  return sets;
}

TriangleMesh body_of(const ClothShape& shape, const Eigen::Isometry3d& world_from_body, const cv::Vec3f& albedo) {
  if (const auto* s = std::get_if<MeshShape>(&shape))
    return body(*s->mesh, s->placement.unit_mm, world_from_body, albedo);
  TriangleMesh mesh{.albedo = cv::Mat3f(1, 1, albedo)};
  const auto add = [&](const Vector3d& point) { mesh.vertices.push_back((world_from_body * point).cast<float>()); };
  if (const auto* s = std::get_if<SwatchShape>(&shape)) {
    add_grid(mesh, 1, 1, [&](int column, int row) {
      add({s->width_mm * (column - 0.5), s->height_mm * (row - 0.5), 0});
    });
  } else {
    const auto& c = std::get<CylinderShape>(shape);
    const int facets = facets_around();
    add_grid(mesh, facets, 1, [&](int column, int row) {
      add(c.radius_mm * outwards(facet_angle(column, facets)) + Vector3d(0, 0, c.height_mm * row));
    });
  }
  return mesh;
}

}  // namespace renderer
