// What a rendering takes of the memory, told apart by what it is for.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "renderer/picture/film.h"
#include "renderer/trace/ray_scene.h"
#include "station/cloth/render/build_scene.h"

namespace station {

// Bytes that a rendering takes.
struct RenderMemory {
  // Of the patches of all cloths: x, y, z and radius in float, all that is stored of a weave.
  std::size_t control_points = 0;
  renderer::SceneMemory scene;  // with the copies that reach into a patch from its neighbours
  std::size_t film = 0;
  double explicit_yarns = 0;  // control points that the cloths would have as explicit yarns
  std::size_t peak = 0;       // of the process so far, libraries and all
};

// The memory of a scene that is traced into `film`. `cloths`: those of the scene.
RenderMemory memory_of(const SceneFile& scene, const std::vector<BuiltCloth>& cloths,
                       const renderer::SceneMemory& traced, const renderer::Film& film);

nlohmann::json to_json(const RenderMemory& memory);
std::string describe(const RenderMemory& memory);

}  // namespace station
