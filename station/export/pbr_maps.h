// The maps of a physically based material as the files have them, 8 bits a channel, and back to what a viewer reads in them.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "station/export/pbr_texels.h"

namespace station {

// Of one side of a cloth; every map repeats without a seam.
struct PbrMaps {
  cv::Mat1b gloss;               // linear: strength of highlight and sheen
  cv::Mat3b specular_color;      // sRGB, times specular_level
  cv::Mat3b sheen_color;         // sRGB, times sheen: with the strength in it
  cv::Mat3b base_color;          // sRGB: diffuse colour of what is not let through; the next texel's in holes
  cv::Mat1b opacity;             // linear
  cv::Mat3b normal;              // (n + 1) / 2, y up (OpenGL); to be scaled by the material's normal_scale
  cv::Mat1b transmission;        // linear, times transmission_factor: share of the diffuse light that is let through
  cv::Mat3b transmission_color;  // sRGB
  double transmission_factor = 1;
};

PbrMaps maps_of(const BakedSide& side, const GltfShader& shader);

// Row by row.
std::vector<PbrTexel> texels_of(const PbrMaps& maps, double normal_scale);

// Mean linear colour, for programs that use no textures.
Eigen::Array3d mean_color(const cv::Mat3b& srgb);
cv::Mat4b with_alpha(const cv::Mat3b& rgb, const cv::Mat1b& alpha);

// One PNG for each map, those that are constant too. Errors: those of renderer::write_png.
void write_texture_set(const std::filesystem::path& folder, const PbrMaps& maps, const GltfMaterial& material);

}  // namespace station
