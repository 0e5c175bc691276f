// The data term of the fit as one vector of residuals: block averages of all views, rendered minus photographed.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "inversion/fit/light_paths.h"
#include "inversion/fit/scattering_family.h"
#include "inversion/view/blocks.h"

namespace inversion {

class ViewObjective {
 public:
  // Refers to the views: they must outlive it. Of each view's blocks every `block_stride`-th counts, for a first look:
  // as many paths say more of a misfit in fewer blocks, because the misfit grows with the number of blocks and its
  // noise with the power 3/2 of it.
  ViewObjective(const WrappedSpool& spool, const std::vector<View>& views, const ScatteringFamily& family,
                int block_stride = 1);

  // Records the light paths that residuals() shades from now on. Calls step(done, total) after each view.
  void trace(const Eigen::VectorXd& traced_with, int paths_per_block, std::uint64_t seed,
             const std::function<void(int, int)>& step);

  int residual_count() const { return static_cast<int>(3 * block_count_); }
  std::size_t block_count() const { return block_count_; }
  int block_px() const { return block_px_; }

  // residuals: sqrt(2 w_i n_b) (I - I_ref) / diffuser, so that half their squared norm is the loss; block after block,
  // RGB. jacobian: residuals x unknowns, row-major, or null. One call shades every path: the fit's whole cost.
  void residuals(const Eigen::VectorXd& unknowns, double* residuals, double* jacobian) const;

  // The residuals from either half of the paths, whose errors are independent of each other.
  struct Halves {
    std::array<Eigen::VectorXd, 2> residuals;
    std::array<Eigen::MatrixXd, 2> jacobians;
    Eigen::VectorXd variances;  // residual_variances() of the whole
  };
  Halves halves(const Eigen::VectorXd& unknowns, bool with_jacobians = true) const;  // without them: empty

  // The variance of each residual: the photographs' noise (View::noise) and that of the light paths.
  Eigen::VectorXd residual_variances(const Eigen::VectorXd& unknowns) const;
  Eigen::VectorXd photograph_variances() const;  // the photographs' part of them
  // Weighs every block anew by how far off it is at the unknowns (robust_weights.h), for all calls from now on. Returns
  // the weight of each view.
  std::vector<double> weigh_robustly(const Eigen::VectorXd& unknowns);

  // Factors that make residuals() relative: half their squared norm is then half the mean of (I - I_ref)^2 / (I_ref m),
  // m being the view's mean over all blocks and channels. Of I_ref at least a tenth of its channel's mean is taken.
  Eigen::VectorXd relative_scales() const;

  // The number of the view that each residual belongs to.
  std::vector<int> residual_views() const;

 private:
  struct ViewBlocks {
    const View* view;
    std::vector<Block> blocks;
    std::vector<Eigen::Array3d> variances;   // of the references, 0 where the view says nothing
    std::vector<Eigen::Array3d> references;  // means of the photograph's blocks over the diffuser's radiance
    Eigen::Array3d scale;                    // block estimates times this are radiances over the diffuser's
    double weight;                           // w_i
    std::vector<double> robust{};            // of each block, 0 ... 1; empty: 1
    LightPaths paths{};
    std::size_t first_block;
  };

  static double residual_weight(const ViewBlocks& view, std::size_t block);
  // Of the block's residual, where its estimate has the variance `of_paths`.
  static Eigen::Vector3d variance(const ViewBlocks& view, std::size_t block, const Eigen::Array3d& of_paths);

  ScatteringFamily family_;
  renderer::RayScene rays_;
  int block_px_;
  std::size_t block_count_ = 0;
  std::vector<ViewBlocks> views_;
};

}  // namespace inversion
