// Statistics that judge any curve scattering model: chi-square of its sampling against its density, and the sampled
// furnace.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "renderer/scattering/lobes.h"

namespace renderer {

// Probability of at least this disagreement between `samples` sampled directions and the density, if they agree.
double sampling_p_value(const CurveLobes<double>& lobes, int samples, std::uint64_t seed);

struct SampledMean {
  Rgb<double> mean;
  Rgb<double> standard_error;
};

// Mean of f_cos / pdf over sampled directions: the albedo.
SampledMean sampled_albedo(const CurveLobes<double>& lobes, int samples, std::uint64_t seed);

}  // namespace renderer
