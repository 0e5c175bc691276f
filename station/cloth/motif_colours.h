// The absorptions of a motif's threads that give each of its regions its colour where it is sewn: with the light of the
// neighbours, the ground between stitches, and the stitches as they lie [Xia 2025, section 6, figure 13].
//
// A region is what is seen of one thread from above. Its mean reflectance under light of 1 from everywhere is asked to
// be the wanted one. Absorptions follow from the curve of satin stitches (cloth_colour.h) at a reflectance that is
// moved, step by step, by what the region still lacks: neighbours change a region's colour by far less than its own
// absorption, so that the steps converge. A colour too bright for the thread becomes darker in its hue. Every step has
// the same paths, whose noise a region's many pixels average.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "renderer/picture/camera.h"
#include "renderer/scene/scene.h"
#include "station/cloth/cloth_colour.h"

namespace station {

struct MotifColours {
  std::vector<renderer::ThreadParameters> threads;
  // Of each thread's region, camera RGB: by the curve alone, and in the end. Nothing where none of it is seen.
  std::vector<std::optional<Eigen::Array3d>> by_curve, seen;
};

struct MotifColourRequest {
  std::vector<renderer::ThreadParameters> threads;    // by the curve alone
  std::vector<std::optional<Eigen::Array3d>> wanted;  // camera RGB; nothing: the thread stays as it is
  std::function<renderer::Scene(const std::vector<renderer::ThreadParameters>&)> scene;
  std::vector<std::size_t> thread_of_set;  // of each curve set of that scene
  renderer::Camera camera;                 // from above, over all of the motif
  std::uint64_t seed = 1;
  std::function<void(double)> done;  // told the finished part
};

// Errors: std::runtime_error when ctrl-C stops it.
MotifColours fit_motif_colours(const MotifColourRequest& request, const AbsorptionCurves& curves);

}  // namespace station
