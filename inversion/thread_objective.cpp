#include "inversion/thread_objective.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "inversion/block_estimate.h"

namespace inversion {
namespace {

using Row = Eigen::Matrix<double, 1, renderer::kThreadParameterCount>;

void check(const View& view) {
  const std::string name = "view " + view.id;
  if (view.image.empty() || view.image.size() != view.mask.size())
    throw std::runtime_error(name + ": the picture is missing or differs in size from its mask; develop it again");
  if (cv::countNonZero(view.mask) == 0)
    throw std::runtime_error(name + ": the mask is empty; calibrate and develop again");
  if (!(view.light.intensity.minCoeff() > 0))
    throw std::runtime_error(name + ": the lamp has no intensity; calibrate the light again");
}

// Slopes of one channel (thread_gradient.h) in the order of the parameters.
Row parameter_row(const renderer::ThreadSlopes<double>& slopes, int channel) {
  Row row = Row::Zero();
  row[channel] = slopes(renderer::kSlopeSigma, channel);
  for (int k = 1; k < renderer::kThreadSlopeCount; ++k) row[k + 2] = slopes(k, channel);
  return row;
}

}  // namespace

ThreadObjective::ThreadObjective(const WrappedSpool& spool, const std::vector<View>& views)
    : rays_(spool_rays(spool)), block_px_(kBlock_pooled * pooled_px(spool, views)) {
  if (views.empty()) throw std::runtime_error("there is no view to fit a thread to; develop the session first");
  for (const View& view : views) {
    check(view);
    const double diffuser = diffuser_radiance(view.light).mean();
    views_.push_back({.view = &view,
                      .blocks = mask_blocks(view.mask, block_px_),
                      .references = {},
                      .scale = view.light.intensity.array() / diffuser,
                      .weight = 1.0 / cv::countNonZero(view.mask),
                      .first_block = block_count_});
    ViewBlocks& added = views_.back();
    for (const Block& block : added.blocks) added.references.push_back(block_mean(block, view.image) / diffuser);
    block_count_ += added.blocks.size();
  }
}

void ThreadObjective::trace(const renderer::ThreadParameters& traced_with, int paths_per_block, std::uint64_t seed,
                            const std::function<void(int, int)>& step) {
  int done = 0;
  for (ViewBlocks& v : views_) {
    v.paths = trace_light_paths(rays_, *v.view, v.blocks, traced_with, paths_per_block, seed + v.first_block);
    step(++done, static_cast<int>(views_.size()));
  }
}

void ThreadObjective::residuals(const ThreadUnknowns& unknowns, double* residuals, double* jacobian) const {
  const BlockModel model = block_model(parameters_of(unknowns));
  const ThreadJacobian by_unknowns = parameters_by_unknowns(unknowns);
  for (const ViewBlocks& v : views_)
    tbb::parallel_for(std::size_t{0}, v.blocks.size(), [&](std::size_t b) {
      const BlockEstimate estimate = shade_block(v.paths, b, model, jacobian != nullptr);
      const double weight = std::sqrt(2 * v.weight * static_cast<double>(v.blocks[b].pixels.size()));
      for (int c = 0; c < 3; ++c) {
        const std::size_t row = 3 * (v.first_block + b) + static_cast<std::size_t>(c);
        residuals[row] = weight * (v.scale[c] * estimate.value[c] - v.references[b][c]);
        if (!jacobian) continue;
        Eigen::Map<Row>(jacobian + row * renderer::kThreadParameterCount) =
            weight * v.scale[c] * parameter_row(estimate.slopes, c) * by_unknowns;
      }
    });
}

}  // namespace inversion
