#include "station/cloth/render/build_scene.h"

#include <array>
#include <stdexcept>

#include "renderer/embroidery/sewn_curves.h"
#include "renderer/embroidery/stitch_curves.h"
#include "renderer/scene/patch_curves.h"
#include "renderer/weave/patch_measures.h"
#include "station/output/watched_work.h"

namespace station {
namespace {

renderer::ClothShape built(const SceneShape& shape, ProgressDisplay& progress) {
  const auto* garment = std::get_if<SceneGarment>(&shape);
  if (garment) {
    constexpr std::array<const char*, 4> kNames{"the ready skirt", "the ready pleats", "the ready drape",
                                                "the ready sari"};
    return renderer::MeshShape{.mesh = std::make_shared<renderer::UvMesh>(garment_watched(garment->shape, progress)),
                               .placement = {.uv_mm = 1, .turn_rad = garment->turn_rad},
                               .name = kNames.at(garment->shape.index())};
  }
  if (const auto* mesh = std::get_if<renderer::MeshShape>(&shape)) return *mesh;
  if (const auto* tube = std::get_if<renderer::CylinderShape>(&shape)) return *tube;
  return std::get<renderer::SwatchShape>(shape);
}

// An embroidery's threads as curves, each with its scattering, on a cloth at this surface.
std::vector<renderer::CurveSet> sewn(const SceneEmbroidery& embroidery, const renderer::YarnPatch& patch,
                                     const renderer::ClothSurface& surface) {
  const renderer::MotifMeasures extents = renderer::measure(embroidery.motif);
  renderer::MotifPlace place{.turn_rad = embroidery.turn_rad};
  place.at_mm =
      embroidery.at_mm.value_or(renderer::middle_of(surface)) - place.on_cloth((extents.low + extents.high) / 2);
  std::vector<renderer::CurveSet> sets;
  renderer::StitchCurves stitches = renderer::stitch_curves(embroidery.motif, embroidery.diameter_mm);
  for (std::size_t i = 0; i < stitches.threads.size(); ++i) {
    if (stitches.threads[i].segments.empty()) continue;
    stitches.threads[i].scattering = embroidery.threads[i];
    sets.push_back(std::move(stitches.threads[i]));
  }
  return renderer::sewn_curves(std::move(sets), place, surface, renderer::surface_range(patch).high_mm);
}

// Flyaways absorb as much on their way as the cloth's first thread does.
std::optional<renderer::Flyaways> flyaways_of(const SceneCloth& cloth, const renderer::YarnPatch& patch,
                                              const std::vector<renderer::ScatteringModel>& threads) {
  if (!cloth.fibers || !cloth.fibers->flyaways) return std::nullopt;
  renderer::Flyaways flyaways = *cloth.fibers->flyaways;
  const renderer::Yarn& yarn = patch.yarns.front();
  const int first = yarn.threads.empty() ? yarn.thread : yarn.threads.front();
  if (const auto* thread = std::get_if<renderer::ThreadParameters>(&threads.at(static_cast<std::size_t>(first))))
    flyaways.fiber.sigma_a = thread->sigma_a * (flyaways.diameter_mm / 2 / yarn.radius_mm);
  return flyaways;
}

}  // namespace

renderer::YarnPatch woven_cloth(const SceneFile& file, std::size_t cloth, ProgressDisplay& progress) {
  const auto& weave = file.cloths.at(cloth).weave;
  const auto* draft = std::get_if<renderer::Draft>(&weave);
  if (!draft) return std::get<renderer::YarnPatch>(weave);
  renderer::YarnPatch patch = weave_watched(*draft, progress).patch;
  if (const auto problem = missing_thread(patch.name, renderer::threads_of(patch), file.threads.size()))
    throw std::runtime_error(file.source + ": key \"cloths[" + std::to_string(cloth) + "].draft\": " + *problem);
  return patch;
}

std::vector<BuiltCloth> build_cloths(const SceneFile& file, ProgressDisplay& progress) {
  std::vector<BuiltCloth> cloths;
  for (std::size_t i = 0; i < file.cloths.size(); ++i)
    cloths.push_back({woven_cloth(file, i, progress), built(file.cloths[i].shape, progress)});
  return cloths;
}

renderer::Scene build_scene(const SceneFile& file, const std::vector<BuiltCloth>& cloths) {
  renderer::Scene scene;
  const std::vector<renderer::ScatteringModel>& threads = file.threads;
  for (std::size_t i = 0; i < file.cloths.size(); ++i) {
    const auto& [patch, shape] = cloths.at(i);
    const Eigen::Isometry3d& world_from_cloth = file.cloths[i].world_from_cloth;
    if (file.cloths[i].two_scale) {
      scene.cloths.push_back({.surface = renderer::surface_of(shape, patch, world_from_cloth),
                              .patch = patch,
                              .threads = threads,
                              .absorption = file.cloths[i].absorption,
                              .flyaways = flyaways_of(file.cloths[i], patch, threads)});
      if (file.cloths[i].fibers) scene.cloths.back().fibers = file.cloths[i].fibers->detail;
    } else {
      for (renderer::CurveSet& set : renderer::explicit_curves(shape, patch, threads, world_from_cloth))
        scene.curves.push_back(std::move(set));
    }
  }
  for (const SceneEmbroidery& embroidery : file.embroideries) {
    const auto i = static_cast<std::size_t>(embroidery.cloth);
    const auto& [patch, shape] = cloths.at(i);
    for (renderer::CurveSet& set :
         sewn(embroidery, patch, renderer::surface_of(shape, patch, file.cloths[i].world_from_cloth)))
      scene.curves.push_back(std::move(set));
  }
  ProgressDisplay quiet("bodies", ProgressStyle::quiet);
  for (const SceneBody& body : file.objects)
    scene.meshes.push_back(renderer::body_of(built(body.shape, quiet), body.world_from_object, body.albedo));
  scene.lights = file.lights;
  scene.rectangles = file.rectangles;
  scene.surroundings = file.surroundings;
  return scene;
}

}  // namespace station
