#include "inversion/fit/view_objective.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "inversion/fit/block_estimate.h"
#include "inversion/solve/robust_weights.h"

namespace inversion {
namespace {

void check(const View& view) {
  const std::string name = "view " + view.id;
  if (view.image.empty() || view.image.size() != view.mask.size())
    throw std::runtime_error(name + ": the picture is missing or differs in size from its mask; develop it again");
  if (cv::countNonZero(view.mask) == 0)
    throw std::runtime_error(name + ": the mask is empty; calibrate and develop again");
  if (!(view.light.intensity.minCoeff() > 0))
    throw std::runtime_error(name + ": the lamp has no intensity; calibrate the light again");
}

// The variance of the block's mean; the noise of its pixels is independent.
Eigen::Array3d mean_variance(const Block& block, const View& view) {
  if (!view.noise) return Eigen::Array3d::Zero();
  return variance_by(*view.noise, block_mean(block, view.image)) / static_cast<double>(block.pixels.size());
}

// At least one.
std::vector<Block> every(int stride, std::vector<Block> blocks) {
  std::vector<Block> kept;
  for (std::size_t i = 0; i < blocks.size(); i += static_cast<std::size_t>(stride))
    kept.push_back(std::move(blocks[i]));
  return kept;
}

}  // namespace

ViewObjective::ViewObjective(const WrappedSpool& spool, const std::vector<View>& views, const ScatteringFamily& family,
                             int block_stride)
    : family_(family), rays_(spool_rays(spool)), block_px_(kBlock_pooled * pooled_px(spool, views)) {
  if (views.empty()) throw std::runtime_error("there is no view to fit a thread to; develop the session first");
  for (const View& view : views) {
    check(view);
    const double diffuser = diffuser_radiance(view.light).mean();
    views_.push_back({.view = &view,
                      .blocks = every(block_stride, mask_blocks(view.mask, block_px_)),
                      .variances = {},
                      .references = {},
                      .scale = view.light.intensity.array() / diffuser,
                      .weight = 1.0 / cv::countNonZero(view.mask),
                      .first_block = block_count_});
    ViewBlocks& added = views_.back();
    for (const Block& block : added.blocks) {
      added.references.push_back(block_mean(block, view.image) / diffuser);
      added.variances.push_back(mean_variance(block, view) / (diffuser * diffuser));
    }
    block_count_ += added.blocks.size();
  }
}

void ViewObjective::trace(const Eigen::VectorXd& traced_with, int paths_per_block, std::uint64_t seed,
                          const std::function<void(int, int)>& step) {
  const renderer::ScatteringModel model = model_at(family_, traced_with);
  int done = 0;
  for (ViewBlocks& v : views_) {
    v.paths = trace_light_paths(rays_, *v.view, v.blocks, model, paths_per_block, seed + v.first_block);
    step(++done, static_cast<int>(views_.size()));
  }
}

void ViewObjective::residuals(const Eigen::VectorXd& unknowns, double* residuals, double* jacobian) const {
  const BlockShader shader = shader_at(family_, unknowns);
  const auto count = unknowns.size();
  for (const ViewBlocks& v : views_)
    tbb::parallel_for(std::size_t{0}, v.blocks.size(), [&](std::size_t b) {
      const BlockEstimate estimate = shade(shader, v.paths, b, jacobian != nullptr);
      const double weight = residual_weight(v, b);
      const std::size_t first = 3 * (v.first_block + b);
      Eigen::Map<Eigen::Array3d>(residuals + first) = weight * (v.scale * estimate.value - v.references[b]);
      if (!jacobian) return;
      using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<Rows>(jacobian + first * static_cast<std::size_t>(count), 3, count) =
          (weight * v.scale).matrix().asDiagonal() * by_unknowns(shader, estimate.slopes);
    });
}

ViewObjective::Halves ViewObjective::halves(const Eigen::VectorXd& unknowns, bool with_jacobians) const {
  const BlockShader shader = shader_at(family_, unknowns);
  Halves both;
  for (std::size_t h = 0; h < 2; ++h) {
    both.residuals[h].resize(residual_count());
    if (with_jacobians) both.jacobians[h].resize(residual_count(), unknowns.size());
  }
  both.variances.resize(residual_count());
  for (const ViewBlocks& v : views_)
    tbb::parallel_for(std::size_t{0}, v.blocks.size(), [&](std::size_t b) {
      const BlockEstimate estimate = shade(shader, v.paths, b, with_jacobians);
      const double weight = residual_weight(v, b);
      const auto first = static_cast<Eigen::Index>(3 * (v.first_block + b));
      for (std::size_t h = 0; h < 2; ++h) {
        const HalfEstimate& half = estimate.halves[h];
        both.residuals[h].segment<3>(first) = (weight * (v.scale * half.value - v.references[b])).matrix();
        if (with_jacobians)
          both.jacobians[h].middleRows<3>(first) =
              (weight * v.scale).matrix().asDiagonal() * by_unknowns(shader, half.slopes);
      }
      both.variances.segment<3>(first) = variance(v, b, estimate.variance);
    });
  return both;
}

Eigen::VectorXd ViewObjective::residual_variances(const Eigen::VectorXd& unknowns) const {
  const BlockShader shader = shader_at(family_, unknowns);
  Eigen::VectorXd variances(residual_count());
  for (const ViewBlocks& v : views_)
    tbb::parallel_for(std::size_t{0}, v.blocks.size(), [&](std::size_t b) {
      variances.segment<3>(static_cast<Eigen::Index>(3 * (v.first_block + b))) =
          variance(v, b, shade(shader, v.paths, b, false).variance);
    });
  return variances;
}

Eigen::VectorXd ViewObjective::photograph_variances() const {
  Eigen::VectorXd variances(residual_count());
  for (const ViewBlocks& v : views_)
    for (std::size_t b = 0; b < v.blocks.size(); ++b) {
      const double weight = residual_weight(v, b);
      variances.segment<3>(static_cast<Eigen::Index>(3 * (v.first_block + b))) =
          (weight * weight * v.variances[b]).matrix();
    }
  return variances;
}

std::vector<double> ViewObjective::weigh_robustly(const Eigen::VectorXd& unknowns) {
  const BlockShader shader = shader_at(family_, unknowns);
  std::vector<WeighedView> weighed;
  for (const ViewBlocks& v : views_) {
    WeighedView& view = weighed.emplace_back();
    view.transmission = v.view->transmission;
    view.misfits.resize(v.blocks.size());
    view.noise_variances.resize(v.blocks.size());
    tbb::parallel_for(std::size_t{0}, v.blocks.size(), [&](std::size_t b) {
      const BlockEstimate estimate = shade(shader, v.paths, b, false);
      view.misfits[b] = std::sqrt((v.scale * estimate.value - v.references[b]).square().mean());
      view.noise_variances[b] = v.variances[b].mean();
    });
    for (const Eigen::Array3d& reference : v.references)
      view.mean_reference += reference.mean() / static_cast<double>(v.references.size());
  }
  RobustWeights weights = robust_weights(weighed);
  for (std::size_t i = 0; i < views_.size(); ++i) views_[i].robust = std::move(weights.blocks[i]);
  return weights.views;
}

Eigen::VectorXd ViewObjective::relative_scales() const {
  constexpr double kLeastOfMean = 0.1;
  Eigen::VectorXd scales(residual_count());
  for (const ViewBlocks& v : views_) {
    Eigen::Array3d mean = Eigen::Array3d::Zero();
    for (const Eigen::Array3d& reference : v.references) mean += reference / static_cast<double>(v.references.size());
    for (std::size_t b = 0; b < v.blocks.size(); ++b)
      scales.segment<3>(static_cast<Eigen::Index>(3 * (v.first_block + b))) =
          (residual_weight(v, b) * (v.references[b].max(kLeastOfMean * mean) * mean.mean() * residual_count()).sqrt())
              .inverse();
  }
  return scales;
}

std::vector<int> ViewObjective::residual_views() const {
  std::vector<int> views;
  for (std::size_t v = 0; v < views_.size(); ++v)
    views.insert(views.end(), 3 * views_[v].blocks.size(), static_cast<int>(v));
  return views;
}

Eigen::Vector3d ViewObjective::variance(const ViewBlocks& view, std::size_t block, const Eigen::Array3d& of_paths) {
  const double weight = residual_weight(view, block);
  return (weight * weight) * (view.scale.square() * of_paths + view.variances[block]).matrix();
}

double ViewObjective::residual_weight(const ViewBlocks& view, std::size_t block) {
  const double robust = view.robust.empty() ? 1 : view.robust[block];
  return std::sqrt(2 * robust * view.weight * static_cast<double>(view.blocks[block].pixels.size()));
}

}  // namespace inversion
