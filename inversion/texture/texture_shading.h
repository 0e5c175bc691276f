// The shading of stored paths through a cloth (texture_paths.h) with a texture of absorptions, one texel per crossing:
// the values, and the derivatives that fit_texture()'s descent needs.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "inversion/texture/texture_paths.h"

namespace inversion {

using Channels = Eigen::Array4f;  // R, G, B and an unused one

// The mean value of the paths where all cloth has one absorption, in all channels.
Channels uniform_value(const CrossingPaths& paths, float sigma_a);

// The absorption of one texel, with what its crossing's curve says of it.
struct TexelState {
  Channels sigma_a = Channels::Zero();
  Channels curve_reflectance = Channels::Zero();  // of cloth that has this absorption everywhere
  Channels curve_slope = Channels::Constant(-1);  // derivative of that by the absorption
};

// A texture over the repeats of a cloth, and those paths of its crossings that leave them (those_that_mix()); the
// texture repeats too.
class TextureShading {
 public:
  TextureShading(std::vector<CrossingPaths> mixing, Eigen::Vector2i crossings, cv::Size size)
      : mixing_(std::move(mixing)), crossings_(std::move(crossings)), size_(size) {}

  // The reflectance of each texel: curve_reflectance + mean over paths of [value(texture) - value(all cloth has the
  // texel's absorption)]. `paths` of the stored paths are used; which ones differs from texel to texel and by `draw`.
  cv::Mat3f reflectance(const std::vector<TexelState>& texels, int paths, std::uint64_t draw) const;

  // With residuals r = reflectance R - target and weights w, of the unknowns x = curve_reflectance:
  //   gradient = sum_p w_p r_p dR_p / dx,  steepness = sum_p w_p |dR_p / dx| sum_q |dR_p / dx_q|.
  struct Descent {
    std::vector<Channels> gradient, steepness;
    double loss = 0;  // sum of w r^2
  };
  Descent descent(const std::vector<TexelState>& texels, const cv::Mat3f& target, const std::vector<Channels>& weights,
                  int paths, std::uint64_t draw) const;

  // The number of a texel's crossing in the repeat.
  std::size_t crossing(int row, int column) const;

 private:
  // The stored paths of a texel, and which of them comes first.
  struct Draw {
    const CrossingPaths& paths;
    std::size_t first;
  };
  Draw drawn(int row, int column, std::uint64_t draw) const;

  std::vector<CrossingPaths> mixing_;
  Eigen::Vector2i crossings_;
  cv::Size size_;
};

}  // namespace inversion
