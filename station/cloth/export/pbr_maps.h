// The maps of a physically based material with 8 bits a channel as the files have them, and the way back to what a
// viewer reads in them.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "station/cloth/export/pbr_texels.h"

namespace station {

// The maps of one side of a cloth; every map repeats without a seam.
struct PbrMaps {
  cv::Mat1b gloss;               // linear: strength of highlight and sheen
  cv::Mat3b specular_color;      // sRGB; the material's specular_level multiplies it
  cv::Mat3b sheen_color;         // sRGB, includes the strength; the material's sheen multiplies it
  cv::Mat3b base_color;          // sRGB: diffuse colour of what is not let through; in holes that of yarns near by
  cv::Mat1b opacity;             // linear
  cv::Mat3b normal;              // (n + 1) / 2, y up (OpenGL); the material's normal_scale multiplies x and y
  cv::Mat1b transmission;        // linear; transmission_factor times it is the share of diffuse light let through
  cv::Mat3b transmission_color;  // sRGB
  double transmission_factor = 1;
};

// The maps of a baked side.
PbrMaps maps_of(const BakedSide& side, const GltfShader& shader);

// The texels that a viewer reads in the maps, row by row.
std::vector<PbrTexel> texels_of(const PbrMaps& maps, double normal_scale);

// The mean linear colour, for programs that use no textures.
Eigen::Array3d mean_color(const cv::Mat3b& srgb);
cv::Mat4b with_alpha(const cv::Mat3b& rgb, const cv::Mat1b& alpha);

// Writes one PNG for each map, constant ones too. Errors: those of renderer::write_png.
void write_texture_set(const std::filesystem::path& folder, const PbrMaps& maps, const GltfMaterial& material);

// As pixels hold it.
inline cv::Vec3f color_of(const Eigen::Array3d& a) {
  return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

}  // namespace station
