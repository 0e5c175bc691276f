// A block's radiance for any parameters of a scattering model, from recorded light paths, with its derivatives.
//
//   value = mean over paths of A_1,   A_v = w_v f_v(light) + f_v(next) / pdf_v A_(v+1)              (light_paths.h)
//
// A path's slopes are therefore the sum over its directions of weight d f_cos: T_v w_v for the light's, T_v / pdf_v
// A_(v+1) for the next one, with T_v the product of f_u(next) / pdf_u before. First come the values of all directions,
// then the weights path by path, then the slopes; the first and the last of these in packets of floats.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "inversion/fit/light_paths.h"
#include "renderer/scattering/fiber_gradient.h"
#include "renderer/scattering/packet.h"
#include "renderer/scattering/thread_gradient.h"
#include "renderer/scattering/yarn_gradient.h"

namespace inversion {

// One of two estimates from paths of their own: the first and the second half of the batches.
struct HalfEstimate {
  Eigen::Array3d value = Eigen::Array3d::Zero();
  renderer::ThreadSlopes<double> slopes = renderer::ThreadSlopes<double>::Zero();
};

// The estimate of a block's radiance per unit of the lamp's intensity (1/mm^2), RGB.
struct BlockEstimate {
  Eigen::Array3d value = Eigen::Array3d::Zero();
  renderer::ThreadSlopes<double> slopes =
      renderer::ThreadSlopes<double>::Zero();        // rows: ThreadSlope, FiberSlope or YarnSlope
  Eigen::Array3d variance = Eigen::Array3d::Zero();  // of `value`, as the spread of the batches shows it
  std::array<HalfEstimate, 2> halves{};              // zero where there are fewer paths than batches
};

using BlockPacket = renderer::Packet<renderer::kPacketWidth>;
using BlockModel = renderer::ThreadGradientModel<BlockPacket>;
using FiberBlockModel = renderer::FiberGradientModel<BlockPacket>;
using YarnBlockModel = renderer::YarnGradientModel<float>;  // one direction at a time
// The models that shade blocks with these parameters.
BlockModel block_model(const renderer::ThreadParameters& parameters);
FiberBlockModel block_model(const renderer::FiberParameters& parameters);
YarnBlockModel block_model(const renderer::YarnParameters& parameters);

// The estimate of a block. The paths must have been traced with the same kind of model; Model is one of the three
// above.
template <class Model>
BlockEstimate shade_block(const LightPaths& paths, std::size_t block, const Model& model, bool with_slopes);

}  // namespace inversion
