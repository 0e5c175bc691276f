// A cloth beside the material that it was exported as: the two-scale renderer's picture, a plain shading of the exported maps by
// glTF's formulas in the same light and view, and where they differ.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "station/export/cloth_far_field.h"
#include "station/export/pbr_maps.h"

namespace station {

struct SheetOptions {
  int samples_per_pixel = 32;
  int samples_per_pair = 16384;  // of the curves from afar
  std::uint64_t seed = 1;
  PartProgress progress = [](double) { return true; };
};

struct ComparedView {
  std::string name;
  double mean_delta_e = 0, delta_e_95 = 0;  // CIEDE2000 of block averages, without any scaling of brightness
};

struct ClothSheet {
  cv::Mat3b picture;                // sRGB
  cv::Mat3b preview;                // sRGB: the cloth from above under even light, kSheetPeriods across
  std::vector<ComparedView> views;  // rows of the picture
};

inline constexpr int kSheetPeriods = 3;  // both ways

// Slanted views are stretched to the shape of the straight one. Errors: those of render_or_stop; gnuplot is missing.
ClothSheet draw_sheet(const ClothSample& cloth, const PbrMaps& maps, const GltfShader& shader,
                      const SheetOptions& options);

// Paths that draw_sheet traces, about.
double paths_of_sheet(const ClothSample& cloth, const SheetOptions& options);

// The maps, shaded: radiance in linear sRGB for one light as far_field() has it. `camera` sees whole periods.
cv::Mat3f shaded_maps(const PbrMaps& maps, const GltfShader& shader, const Eigen::Vector2d& period_mm,
                      const renderer::Camera& camera, const Eigen::Vector3d& to_view,
                      const Eigen::Vector3d& to_light);

nlohmann::json to_json(const ComparedView& view);

}  // namespace station
