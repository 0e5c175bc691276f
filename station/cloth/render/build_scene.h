// From what a scene file says (documents/scene_file.h) to what is rendered: drafts are woven, garments draped, motifs
// sewn on.
#pragma once

#include <vector>

#include "renderer/scene/scene.h"
#include "station/documents/scene_file.h"
#include "station/output/progress.h"

namespace station {

// The patch of one of the scene's cloths. This is long work: the yarns of a draft are relaxed. Errors: those of
// weave_watched (output/watched_work.h); std::runtime_error, one line, for a yarn of a thread that the scene does not
// list.
renderer::YarnPatch woven_cloth(const SceneFile& file, std::size_t cloth, ProgressDisplay& progress);

// A cloth that is woven and whose shape is made, which takes long.
struct BuiltCloth {
  renderer::YarnPatch patch;
  renderer::ClothShape shape;
};
// All cloths of the scene, in their order. Errors: those of woven_cloth and garment_watched.
std::vector<BuiltCloth> build_cloths(const SceneFile& file, ProgressDisplay& progress);

// The scene for the path tracer. `cloths`: those of the same file. Errors: those of renderer::surface_of,
// explicit_curves, stitch_curves and sewn_curves.
renderer::Scene build_scene(const SceneFile& file, const std::vector<BuiltCloth>& cloths);

}  // namespace station
