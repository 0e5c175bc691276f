// The pictures' part of the paper's loss, pixel by pixel [Xia 2025, eq. 6], and its gradient from random numbers of
// their own: the product of a picture's errors and its slopes has no part of the paths' noise when the two come from
// different paths, as they do in differentiable renderers.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "inversion/fit/scattering_family.h"
#include "inversion/view/view.h"
#include "inversion/view/wrapped_spool.h"
#include "renderer/trace/ray_scene.h"

namespace inversion {

class PixelLoss {
 public:
  // Refers to the views, which must outlive it and be usable (ViewObjective refuses others).
  PixelLoss(const WrappedSpool& spool, const std::vector<View>& views, const ScatteringFamily& family);

  // sum over views w_i sum over masked pixels ||I_i - I_ref,i||^2 in units of the diffuser's radiance, w_i = 1 /
  // masked pixels, without the paths' noise: it may be below zero. Traces paths_per_pixel >= kPathBatches paths anew, a
  // part of a view at a time, so that memory does not grow with the pictures.
  double at(const Eigen::VectorXd& unknowns, int paths_per_pixel, std::uint64_t seed, Eigen::VectorXd& gradient) const;

 private:
  const std::vector<View>& views_;
  ScatteringFamily family_;
  renderer::RayScene rays_;
};

}  // namespace inversion
