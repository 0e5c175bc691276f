// A block's radiance for any thread parameters, from recorded light paths, with its derivatives.
//
//   value = mean over paths of A_1,   A_v = w_v f_v(light) + f_v(next) / pdf_v A_(v+1)              (light_paths.h)
//
// A path's slopes are therefore the sum over its directions of weight d f_cos: T_v w_v for the light's, T_v / pdf_v
// A_(v+1) for the next one, with T_v the product of f_u(next) / pdf_u before. First come the values of all directions,
// then the weights path by path, then the slopes; the first and the last of these in packets of floats.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "inversion/light_paths.h"
#include "renderer/scattering/packet.h"
#include "renderer/scattering/thread_gradient.h"

namespace inversion {

// Per unit of the lamp's intensity (1/mm^2), RGB.
struct BlockEstimate {
  Eigen::Array3d value = Eigen::Array3d::Zero();
  renderer::ThreadSlopes<double> slopes = renderer::ThreadSlopes<double>::Zero();  // d value / d parameter
};

using BlockModel = renderer::ThreadGradientModel<renderer::Packet<renderer::kPacketWidth>>;
BlockModel block_model(const renderer::ThreadParameters& parameters);

BlockEstimate shade_block(const LightPaths& paths, std::size_t block, const BlockModel& model, bool with_slopes);

}  // namespace inversion
