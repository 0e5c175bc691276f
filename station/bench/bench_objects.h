// Meshes of what stands on the simulated bench: table, platform, tag board, Spectralon panel, holder with its tags.
// Each mesh is in its object's own frame (mm) unless its function says otherwise.
#pragma once

#include <vector>

#include "inversion/view/wrapped_spool.h"
#include "renderer/scene/scene.h"
#include "station/documents/rig_file.h"

namespace station {

inline constexpr float kBlackPaintAlbedo = 0.03F;

// A dark table at z = 0 and the platform's disc standing on it, in the world frame.
std::vector<renderer::TriangleMesh> table_and_platform(double platform_height_mm, double platform_radius_mm);

// The tags lying on the platform and on the table, in the frame of their layout. They are printed on grey
// paper, because white paper beside the threads would light them by some per cent.
std::vector<renderer::TriangleMesh> lying_tag_meshes(const calibration::TagLayout& tags);

// The tag board. Its middle stands out by `bow_mm`, as one parabola across its width, and its tags follow the slope.
std::vector<renderer::TriangleMesh> board_meshes(const calibration::TagLayout& board, double bow_mm);
std::vector<renderer::TriangleMesh> spectralon_meshes(const SpectralonPanel& panel,
                                                      double droop);  // calibration/light/spectralon.h
// The colour chart. `camera_from_linear_srgb` turns its squares' colours into those of the simulated camera.
std::vector<renderer::TriangleMesh> colour_chart_meshes(const ColourChart& chart,
                                                        const Eigen::Matrix3d& camera_from_linear_srgb);
std::vector<renderer::TriangleMesh> holder_meshes(const inversion::WrappedSpool& spool,
                                                  const calibration::TagLayout& tags);

// Both reference chips, in the holder's frame; their surface is of the Spectralon panel's kind.
std::vector<renderer::TriangleMesh> reference_chip_meshes(const ReferenceChip& chip,
                                                          const inversion::WrappedSpool& spool, double droop);

void transform(renderer::TriangleMesh& mesh, const Eigen::Isometry3d& to_from_mesh);

}  // namespace station
