// What absorption makes a cloth show a picture, everything else of its threads kept [Xia 2025, section 6, figure 12].
//
// One texel is one crossing of a warp and a weft yarn, as on a weaver's point paper. Under light of 1 from everywhere, the
// setting of the paper, a channel's reflectance depends on that channel's absorption alone. For cloth of one colour that is
// a falling curve, measured for each crossing of the repeat and inverted by itself (AbsorptionCurve). Where colours
// meet, light that scatters from yarn to yarn mixes them; a texel's reflectance is then
//
//   R(texel) = curve(sigma_a(texel)) + mean over its paths of [value(texture) - value(all cloth has the texel's sigma_a)]
//
// with the same stored paths twice (texture_shading.h): no noise where there is nothing to mix. Least squares on R, each
// texel weighted as lightness sees it, by gradient descent with other paths in each step. The unknowns are the reflectances that
// the curve gives, whose scale is even where that of absorption is not; each has a step of its own, the separable
// majorizer's (Erdogan and Fessler 1999), so that the error falls. The mean of the last steps averages the paths' noise.
#pragma once

#include <array>
#include <functional>
#include <opencv2/core.hpp>

#include "inversion/absorption_curve.h"
#include "inversion/texture_paths.h"

namespace inversion {

struct TextureFitOptions {
  // Black, 0, is asked for as the darkest that every crossing can have, and white, 1, as the brightest, channel by channel,
  // with all between in proportion; otherwise colours are asked for as they are.
  bool within_gamut = false;
  int steps = 16;             // of descent, the last half averaged; 0: the curves alone
  int paths_per_texel = 64;   // of a step
  int curve_paths = 1 << 19;  // traced, over all crossings of the repeat
  std::uint64_t seed = 1;
  // Called now and then with the finished share of the work; false ends it, with std::runtime_error.
  std::function<bool(double)> progress{};
};

struct TextureFit {
  renderer::AbsorptionTexture curve, refined;  // by the curves alone, and after the descent
  cv::Mat3f curve_reflectance,
      refined_reflectance;  // what either shows, by paths of which no step has seen the choice
  cv::Mat3f asked;          // of the crossings
  cv::Mat1b in_gamut;       // 255 where the curves reach all channels of the picture as it is
};

// `reflectance`: of each crossing, linear camera RGB, the first row at the largest y; not empty. Errors:
// std::runtime_error when stopped; those of ClothGeometry.
TextureFit fit_texture(const TexturedCloth& cloth, const cv::Mat3f& reflectance, const TextureFitOptions& options);

// The curves of the crossings of the repeat, RGB each, from their paths.
std::vector<std::array<AbsorptionCurve, 3>> crossing_curves(const std::vector<CrossingPaths>& paths);

}  // namespace inversion
