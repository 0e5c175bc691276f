// Cloth wrapped on the black cylinder: what is seen of it, and what it is predicted to look like. The cylinder's frame
// (mm) has its origin in the middle of its foot, and z up along its axis.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

#include "renderer/picture/camera.h"
#include "renderer/scene/scene.h"
#include "station/documents/spool.h"

namespace station {

// Adds the black cylinder and the cloth on it, whose lowest yarns touch it, but no lights. `patch` is one period of the
// cloth. Errors: those of renderer::surface_of.
void add_cloth_on_cylinder(renderer::Scene& scene, const renderer::CylinderShape& cylinder,
                           const renderer::YarnPatch& patch, const std::vector<renderer::ScatteringModel>& threads);

// Where a ray first meets the side of the endless cylinder from outside.
std::optional<Eigen::Vector3d> side_point(const renderer::CameraRay& ray, double radius_mm);

// The side of blocks whose averages can be compared: 8 pixels or two repeats of the weave, whichever is more. Such an
// average does not depend on which yarn of the repeat lies where: a hand turned the cylinder, and its yarns begin
// anywhere. `camera` is in the cylinder's frame.
int comparable_block_px(const renderer::YarnPatch& patch, const renderer::Camera& camera);

// A mask that is 255 where the cylinder's side is seen and lit at angles of at least 15 degrees to its surface, away
// from its rims; all of a highlight lies inside. Camera and light are in the cylinder's frame.
cv::Mat1b lit_side(const renderer::CylinderShape& cylinder, const renderer::Camera& camera,
                   const Eigen::Vector3d& light_mm);

}  // namespace station
