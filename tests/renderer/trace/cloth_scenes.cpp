#include "tests/renderer/trace/cloth_scenes.h"

#include <random>

#include "renderer/weave/initial_patch.h"
#include "renderer/weave/woven_patch.h"

namespace renderer {

YarnPatch patch_of(Draft draft, double warp_pitch_mm, double weft_pitch_mm) {
  draft.warp.pitch_mm = warp_pitch_mm;
  draft.weft.pitch_mm = weft_pitch_mm;
  draft.warp.threads = {0};
  draft.weft.threads = {1};
  return initial_patch(draft);
}

YarnPatch plain_patch() {
  return patch_of(plain_draft(), 0.9, 0.9);
}

YarnPatch satin_patch() {
  return patch_of(satin_draft(5, 2), 0.55, 1.1);
}

YarnPatch irregular_patch() {
  Draft draft{.name = "irregular", .warp_over = {}};
  std::mt19937 random(8);
  do {
    draft.warp_over.assign(8, std::vector<bool>(8));
    for (std::vector<bool>& pick : draft.warp_over)
      for (std::size_t end = 0; end < pick.size(); ++end) pick[end] = random() >> 31 != 0;
    draft.warp.pitch_mm = draft.weft.pitch_mm = 0.9;
  } while (check_draft(draft));
  draft.warp.threads = {0}, draft.weft.threads = {1};
  return woven_patch(draft).patch;
}

Scene two_scale_scene(const ClothShape& shape, const YarnPatch& patch, const std::vector<ScatteringModel>& threads,
                      const Eigen::Isometry3d& world_from_cloth) {
  return {.cloths = {{surface_of(shape, patch, world_from_cloth), patch, threads}}};
}

Scene brute_force_scene(const ClothShape& shape, const YarnPatch& patch, const std::vector<ScatteringModel>& threads,
                        const Eigen::Isometry3d& world_from_cloth) {
  return {.curves = explicit_curves(shape, patch, threads, world_from_cloth)};
}

std::vector<ScatteringModel> red_and_blue_threads() {
  return {ThreadParameters{.sigma_a = {0.05, 0.9, 1.1}}, ThreadParameters{.sigma_a = {1.2, 0.7, 0.1}}};
}

ThreadParameters lossless_thread() {
  return {.r0a = 0, .r0b = -0.5, .r0c = 0.9, .r1a = 0.5, .r2a = 0, .r2b = 10, .r2c = 0, .limit_energy = false};
}

Camera camera_on(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up, double width_mm,
                 int width_px, int height_px) {
  Camera camera = look_at(eye, target, up);
  camera.width = width_px, camera.height = height_px;
  camera.fx = camera.fy = width_px * (eye - target).norm() / width_mm;
  camera.cx = (width_px - 1) / 2.0, camera.cy = (height_px - 1) / 2.0;
  return camera;
}

}  // namespace renderer
