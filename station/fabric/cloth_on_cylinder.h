// Cloth wrapped on the black cylinder: what is seen of it, and what it is predicted to look like. Frame of the cylinder (mm):
// origin in the middle of its foot, z up along its axis.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "renderer/camera.h"
#include "renderer/scene.h"
#include "station/documents/spool.h"

namespace station {

// The black cylinder with the cloth on it, its lowest yarns touching it; without lights. `patch`: of the cloth's weave.
// Errors: those of renderer::surface_of.
void add_cloth_on_cylinder(renderer::Scene& scene, const renderer::CylinderShape& cylinder,
                           const renderer::YarnPatch& patch, const std::vector<renderer::ScatteringModel>& threads);

// Side of blocks whose averages can be compared: 8 pixels or two repeats of the weave, whichever is more. Such an average
// does not see which yarn of the repeat lies where: a hand turned the cylinder, and its yarns begin anywhere. Camera in the
// cylinder's frame.
int comparable_block_px(const renderer::YarnPatch& patch, const renderer::Camera& camera);

// 255 where the cylinder's side is seen and lit, neither at less than a slant of 15 degrees and away from its rims; all of a
// highlight lies inside. Camera and light in the cylinder's frame.
cv::Mat1b lit_side(const renderer::CylinderShape& cylinder, const renderer::Camera& camera,
                   const Eigen::Vector3d& light_mm);

}  // namespace station
