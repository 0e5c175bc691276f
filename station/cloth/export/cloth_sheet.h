// A sheet that shows a cloth beside the material that it was exported as: the two-scale renderer's picture, a plain
// shading of the exported maps by glTF's formulas in the same light and view, and their difference.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "station/cloth/export/cloth_far_field.h"
#include "station/cloth/export/pbr_maps.h"

namespace station {

struct SheetOptions {
  int samples_per_pixel = 32;
  int samples_per_pair = 16384;  // for the curves of the far field
  std::uint64_t seed = 1;
  PartProgress progress = [](double) { return true; };
};

struct ComparedView {
  std::string name;
  double mean_delta_e = 0, delta_e_95 = 0;  // CIEDE2000 of block averages, brightness not scaled
};

struct ClothSheet {
  cv::Mat3b picture;                // sRGB
  cv::Mat3b preview;                // sRGB: the cloth from above under even light, kSheetPeriods across
  std::vector<ComparedView> views;  // one per row of the picture
};

inline constexpr int kSheetPeriods = 3;  // shown both ways

// Draws the sheet; slanted views are stretched to the shape of the straight one. Errors: those of render_or_stop;
// std::runtime_error when gnuplot is missing.
ClothSheet draw_sheet(const ClothSample& cloth, const PbrMaps& maps, const GltfShader& shader,
                      const SheetOptions& options);

// The number of paths that draw_sheet traces, roughly.
double paths_of_sheet(const ClothSample& cloth, const SheetOptions& options);

// The shaded maps: radiance in linear sRGB for one light, in the unit of far_field(). `camera` sees whole periods.
cv::Mat3f shaded_maps(const PbrMaps& maps, const GltfShader& shader, const Eigen::Vector2d& period_mm,
                      const renderer::Camera& camera, const Eigen::Vector3d& to_view, const Eigen::Vector3d& to_light);

nlohmann::json to_json(const ComparedView& view);

}  // namespace station
