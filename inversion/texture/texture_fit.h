// The fit of absorptions that make a cloth show a picture, when all else of its threads is kept [Xia 2025, section 6,
// figure 12].
//
// One texel is one crossing of a warp and a weft yarn, as on a weaver's point paper. Under light of 1 from everywhere,
// the setting of the paper, a channel's reflectance depends on that channel's absorption alone. For cloth of one colour
// that is a falling curve, measured for each crossing of the repeat and inverted by itself (AbsorptionCurve). Where
// colours meet, light that scatters from yarn to yarn mixes them; a texel's reflectance is then
//
//   R(texel) = curve(sigma_a(texel)) + mean over its paths of
//              [value(texture) - value(all cloth has the texel's sigma_a)]
//
// with the same stored paths in both terms of the difference (texture_shading.h), so that there is no noise where there
// is nothing to mix. R is fitted by least squares, each texel weighted as lightness sees it, by gradient descent with
// other paths in each step. The unknowns are the reflectances that the curve gives, whose scale is even where that of
// absorption is not. Each unknown has a step of its own, that of the separable majorizer (Erdogan and Fessler 1999), so
// that the error falls. The mean of the last steps averages the paths' noise.
#pragma once

#include <array>
#include <functional>
#include <opencv2/core.hpp>

#include "inversion/texture/absorption_curve.h"
#include "inversion/texture/texture_paths.h"

namespace inversion {

struct TextureFitOptions {
  // Whether the picture is brought within what the cloth can show: black, 0, then is the darkest that every crossing
  // can have, and white, 1, the brightest, channel by channel, with all between in proportion. false: colours are asked
  // for as they are.
  bool within_gamut = false;
  int steps = 16;             // steps of descent, the last half of which are averaged; 0: the curves alone
  int paths_per_texel = 64;   // in one step
  int curve_paths = 1 << 19;  // paths traced over all crossings of the repeat
  std::uint64_t seed = 1;
  // Called now and then with the finished share of the work; false ends it, with std::runtime_error.
  std::function<bool(double)> progress{};
};

struct TextureFit {
  renderer::AbsorptionTexture curve, refined;  // the textures by the curves alone, and after the descent
  cv::Mat3f curve_reflectance,
      refined_reflectance;  // what either shows, by new paths
  cv::Mat3f asked;          // the reflectance that is asked for
  cv::Mat1b in_gamut;       // 255 where the curves reach all channels of the picture as it is
};

// The absorptions of a cloth that shows a picture. `reflectance` is that of each crossing, linear camera RGB, the first
// row at the largest y; not empty. Errors: std::runtime_error when stopped; those of ClothGeometry.
TextureFit fit_texture(const TexturedCloth& cloth, const cv::Mat3f& reflectance, const TextureFitOptions& options);

// The curves of the repeat's crossings, one for each of RGB, from their paths.
std::vector<std::array<AbsorptionCurve, 3>> crossing_curves(const std::vector<CrossingPaths>& paths);

}  // namespace inversion
