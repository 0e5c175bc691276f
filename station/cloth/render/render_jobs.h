// Several scenes rendered one after the other into one folder: the work behind `threadstation render A B C --out DIR`.
#pragma once

#include <filesystem>
#include <vector>

#include "station/cloth/render/render_scene.h"

namespace station {

// Writes DIR/NAME.exr and DIR/NAME.png for each scene. DIR is `common.out`, made where it is missing. Pictures that are
// there already from the same scene, seed, samples and version are kept, unless `common.fresh`; the one that was
// interrupted goes on from its checkpoint, so that the same command again does what is left. Errors: those of
// render_scene; std::runtime_error for two scenes of one name and for an `out` that ends as a picture. All scenes are
// read, and the cloths of those that are not kept built, before the first is rendered.
std::vector<RenderReport> render_scenes(const std::vector<std::filesystem::path>& scenes, const RenderRequest& common,
                                        RenderRanks& ranks);

}  // namespace station
