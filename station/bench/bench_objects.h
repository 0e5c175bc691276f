// Meshes of what stands on the simulated bench: table, platform, tag board, Spectralon panel, holder with its tags.
// Each in its own object frame (mm) unless said otherwise.
#pragma once

#include <vector>

#include "inversion/wrapped_spool.h"
#include "renderer/scene.h"
#include "station/documents/rig_file.h"

namespace station {

// World frame: a dark table at z = 0 and the platform's disc standing on it.
std::vector<renderer::TriangleMesh> table_and_platform(double platform_height_mm, double platform_radius_mm);

// The tags lying on the platform and on the table, in the frame of their layout. Printed on grey paper: white paper
// beside the threads would light them by some per cent.
std::vector<renderer::TriangleMesh> lying_tag_meshes(const calibration::TagLayout& tags);

// `bow_mm`: how far its middle stands out, as one parabola across its width; its tags follow the slope.
std::vector<renderer::TriangleMesh> board_meshes(const calibration::TagLayout& board, double bow_mm);
std::vector<renderer::TriangleMesh> spectralon_meshes(const SpectralonPanel& panel,
                                                      double droop);  // calibration/spectralon.h
// `camera_from_linear_srgb`: what the patches' colours are to the simulated camera.
std::vector<renderer::TriangleMesh> colour_chart_meshes(const ColourChart& chart,
                                                        const Eigen::Matrix3d& camera_from_linear_srgb);
std::vector<renderer::TriangleMesh> holder_meshes(const inversion::WrappedSpool& spool,
                                                  const calibration::TagLayout& tags);

// Both chips, of the panel's kind; holder frame.
std::vector<renderer::TriangleMesh> reference_patch_meshes(const ReferencePatch& patch,
                                                           const inversion::WrappedSpool& spool, double droop);

void transform(renderer::TriangleMesh& mesh, const Eigen::Isometry3d& to_from_mesh);

}  // namespace station
