// Cloth both ways, for tests and benchmarks: as a patch in two scales and as explicit curves.
#pragma once

#include "renderer/camera.h"
#include "renderer/cloth_shape.h"
#include "renderer/scene.h"

namespace renderer {

// Colours of warp (thread 0) and weft (thread 1), in one draft of 0.5 mm yarns.
YarnPatch patch_of(Draft draft, double warp_pitch_mm, double weft_pitch_mm);
YarnPatch plain_patch();  // 0.9 x 0.9 mm: gaps between the yarns
YarnPatch satin_patch();  // satin of 5, 0.55 x 1.1 mm

// A scene with nothing but the cloth.
Scene two_scale_scene(const ClothShape& shape, const YarnPatch& patch, const std::vector<ScatteringModel>& threads,
                      const Eigen::Isometry3d& world_from_cloth = Eigen::Isometry3d::Identity());
Scene brute_force_scene(const ClothShape& shape, const YarnPatch& patch, const std::vector<ScatteringModel>& threads,
                        const Eigen::Isometry3d& world_from_cloth = Eigen::Isometry3d::Identity());

std::vector<ScatteringModel> red_and_blue_threads();
// Keeps all energy: every lambda constant or linear in c such that their sum is 1.
ThreadParameters lossless_thread();

// Frames `width_mm` of the target's surroundings, from `eye`.
Camera camera_on(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up,
                 double width_mm, int width_px, int height_px);

}  // namespace renderer
