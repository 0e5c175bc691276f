#include "inversion/fit/pixel_loss.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <stdexcept>

#include "inversion/fit/light_paths.h"

namespace inversion {
namespace {

using Eigen::VectorXd;

constexpr std::size_t kPixelsAtOnce = 1 << 14;
constexpr std::size_t kPixelsPerTask = 256;

// A part of the loss, without its weight.
struct Part {
  double loss = 0;
  VectorXd gradient;

  Part& operator+=(const Part& other) {
    loss += other.loss;
    gradient += other.gradient;
    return *this;
  }
};

struct PartOfView {
  const View& view;
  std::vector<Block> pixels;  // of one pixel each
  LightPaths paths;

  // Adds the loss of the pixels from `begin` to before `end` to `part`.
  Part loss(const BlockShader& shader, std::size_t begin, std::size_t end, Part part) const {
    const double diffuser = diffuser_radiance(view.light).mean();
    const Eigen::Array3d scale = view.light.intensity.array() / diffuser;
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      const Eigen::Array3d reference = block_mean(pixels[pixel], view.image) / diffuser;
      const auto [a, b] = shade(shader, paths, pixel, true).halves;
      const Eigen::Array3d off_a = scale * a.value - reference, off_b = scale * b.value - reference;
      part.loss += (off_a * off_b).sum();
      part.gradient += by_unknowns(shader, a.slopes).transpose() * (scale * off_b).matrix() +
                       by_unknowns(shader, b.slopes).transpose() * (scale * off_a).matrix();
    }
    return part;
  }
};

}  // namespace

PixelLoss::PixelLoss(const WrappedSpool& spool, const std::vector<View>& views, const ScatteringFamily& family)
    : views_(views), family_(family), rays_(spool_rays(spool)) {}

double PixelLoss::at(const VectorXd& unknowns, int paths_per_pixel, std::uint64_t seed, VectorXd& gradient) const {
  if (paths_per_pixel < kPathBatches)
    throw std::invalid_argument("a fit by pixels was asked for with " + std::to_string(paths_per_pixel) +
                                " light paths each; it needs " + std::to_string(kPathBatches));
  const renderer::ScatteringModel model = model_at(family_, unknowns);
  const BlockShader shader = shader_at(family_, unknowns);
  const Part nothing{.gradient = VectorXd::Zero(unknowns.size())};
  Part whole = nothing;
  for (const View& view : views_) {
    const std::vector<Block> pixels = mask_blocks(view.mask, 1);
    Part of_view = nothing;
    for (std::size_t begin = 0; begin < pixels.size(); begin += kPixelsAtOnce, seed += kPixelsAtOnce) {
      const std::size_t end = std::min(pixels.size(), begin + kPixelsAtOnce);
      PartOfView part{.view = view,
                      .pixels = {pixels.begin() + static_cast<std::ptrdiff_t>(begin),
                                 pixels.begin() + static_cast<std::ptrdiff_t>(end)},
                      .paths = {}};
      part.paths = trace_light_paths(rays_, view, part.pixels, model, paths_per_pixel, seed);
      of_view += tbb::parallel_deterministic_reduce(
          tbb::blocked_range<std::size_t>(0, part.pixels.size(), kPixelsPerTask), nothing,
          [&](const tbb::blocked_range<std::size_t>& range, Part sum) {
            return part.loss(shader, range.begin(), range.end(), std::move(sum));
          },
          [](Part sum, const Part& other) { return sum += other; });
    }
    const double weight = 1 / static_cast<double>(pixels.size());
    whole += {.loss = weight * of_view.loss, .gradient = weight * of_view.gradient};
  }
  gradient = whole.gradient;
  return whole.loss;
}

}  // namespace inversion
