// Scenes of cloth for tests and benchmarks, drawn both ways: as a patch in two scales and as explicit curves.
#pragma once

#include "renderer/picture/camera.h"
#include "renderer/scene/cloth_shape.h"
#include "renderer/scene/scene.h"

namespace renderer {

// The patch of a draft of 0.5 mm yarns, with thread 0 in the warp and thread 1 in the weft.
YarnPatch patch_of(Draft draft, double warp_pitch_mm, double weft_pitch_mm);
YarnPatch plain_patch();  // 0.9 x 0.9 mm: gaps between the yarns
YarnPatch satin_patch();  // satin of 5, 0.55 x 1.1 mm
// Eight shafts raised at random, 0.9 x 0.9 mm, 1.9 mm thick. Round a tube of 12 mm its repeats are stretched by 4.7 %.
YarnPatch irregular_patch();

// The scene with nothing but the cloth, as a patch in two scales or as explicit curves.
Scene two_scale_scene(const ClothShape& shape, const YarnPatch& patch, const std::vector<ScatteringModel>& threads,
                      const Eigen::Isometry3d& world_from_cloth = Eigen::Isometry3d::Identity());
Scene brute_force_scene(const ClothShape& shape, const YarnPatch& patch, const std::vector<ScatteringModel>& threads,
                        const Eigen::Isometry3d& world_from_cloth = Eigen::Isometry3d::Identity());

std::vector<ScatteringModel> red_and_blue_threads();
// A thread that keeps all energy: every lambda is constant or linear in c such that their sum is 1.
ThreadParameters lossless_thread();

// A camera at `eye` whose picture is `width_mm` wide at the target.
Camera camera_on(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up, double width_mm,
                 int width_px, int height_px);

}  // namespace renderer
