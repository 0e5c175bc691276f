// Robust weights: how much each block counts beyond eq. 6's weights, so that a bad view, a border of the mask or a
// speck of dust does not lead the fit astray: of views among their like and of blocks within their view. Beyond what is
// tolerated, as in Huber's weights [1964], they fall with a power of the misfit, so that what is farther off pulls less
// [Beaton and Tukey 1974].
#pragma once

#include <Eigen/Core>
#include <vector>

namespace inversion {

// A view's part in weighing.
struct WeighedView {
  bool transmission = false;
  double mean_reference = 0;              // mean of its blocks, over the diffuser's radiance
  std::vector<double> misfits{};          // of each block: root mean square over RGB, over the diffuser's radiance
  std::vector<double> noise_variances{};  // of each block's misfit; empty: none
};

struct RobustWeights {
  std::vector<double> views;                // 0 ... 1: 1 unless the view disagrees far more than the others
  std::vector<std::vector<double>> blocks;  // 0 ... 1, its view's weight included
};

// The weights. A view counts in full up to kTolerated times the median relative misfit of the views of its side
// (reflections, transmissions), a block up to kTolerated times its view's median misfit; beyond that, a block's weight
// falls as the misfit's square rises, a view's as its fourth power: the others follow a bad view in what they hardly
// tell, and one that still counted for .28 turned another by 16 %. Noise lowers a block's weight where it is larger
// than the misfit that the view has anyway.
inline constexpr double kTolerated = 2.5;
RobustWeights robust_weights(const std::vector<WeighedView>& views);

}  // namespace inversion
