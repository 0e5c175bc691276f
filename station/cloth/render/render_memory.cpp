#include "station/cloth/render/render_memory.h"

#include <sys/resource.h>

#include <cstdio>

namespace station {
namespace {

constexpr std::size_t kControlPoint = 4 * sizeof(float);

std::size_t control_points(const renderer::YarnPatch& patch) {
  std::size_t points = 0;
  for (const renderer::Yarn& yarn : patch.yarns) points += yarn.control_points.size();
  return points * kControlPoint;
}

// The area of the cloth laid flat.
double area_mm2(const renderer::ClothSurface& surface) {
  double area = 0;
  for (const auto& t : surface.triangles) {
    const Eigen::Vector2d a = surface.patch_mm[t[1]] - surface.patch_mm[t[0]],
                          b = surface.patch_mm[t[2]] - surface.patch_mm[t[0]];
    area += std::abs(a.x() * b.y() - a.y() * b.x()) / 2;
  }
  return area;
}

std::size_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

}  // namespace

RenderMemory memory_of(const SceneFile& scene, const std::vector<BuiltCloth>& cloths,
                       const renderer::SceneMemory& traced, const renderer::Film& film) {
  RenderMemory memory{.scene = traced, .film = renderer::bytes_of(film), .peak = peak_bytes()};
  for (std::size_t i = 0; i < cloths.size(); ++i) {
    const auto& [patch, shape] = cloths[i];
    const std::size_t points = control_points(patch);
    memory.control_points += points;
    const double repeats = area_mm2(renderer::surface_of(shape, patch, scene.cloths[i].world_from_cloth)) /
                           (patch.period_x_mm * patch.period_y_mm);
    memory.explicit_yarns += static_cast<double>(points) * repeats;
  }
  return memory;
}

nlohmann::json to_json(const RenderMemory& memory) {
  return {{"control_points_bytes", memory.control_points},
          {"yarns_bytes", memory.scene.yarns},
          {"surfaces_bytes", memory.scene.surfaces},
          {"trees_bytes", memory.scene.trees},
          {"scene_bytes", memory.scene.all()},
          {"film_bytes", memory.film},
          {"explicit_yarns_bytes", memory.explicit_yarns},
          {"peak_bytes", memory.peak}};
}

std::string describe(const RenderMemory& memory) {
  constexpr double kMega = 1e6;
  const auto mega = [](std::size_t bytes) { return static_cast<double>(bytes) / kMega; };
  char text[512];
  std::snprintf(text, sizeof text,
                "patches: %.2f kB of control points (%.1f MB as explicit yarns)\n"
                "scene: %.2f MB = %.3f yarns + %.2f surfaces + %.2f trees\n"
                "film: %.1f MB; the program at most: %.0f MB\n",
                static_cast<double>(memory.control_points) / 1e3, memory.explicit_yarns / kMega,
                mega(memory.scene.all()), mega(memory.scene.yarns), mega(memory.scene.surfaces),
                mega(memory.scene.trees), mega(memory.film), mega(memory.peak));
  return text;
}

}  // namespace station
