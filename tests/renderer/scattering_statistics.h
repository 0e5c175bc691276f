// What judges any curve scattering model: its energy by quadrature and by sampling, chi-square of its sampling
// against its density.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "renderer/scattering/lobes.h"

namespace renderer {

// Unit direction in the local frame of lobes.h.
Vec3<double> direction(double theta, double phi);
// Direction o for an offset h, the surface normal along the local z axis: phi_o = pi/2 + asin(h).
Vec3<double> viewing_direction(double theta, double h);

// Integral of f_cos over the sphere, by quadrature: the white furnace.
double energy(const CurveLobes<double>& lobes, int channel);

// Probability of at least this disagreement between `samples` sampled directions and the density, if they agree.
double sampling_p_value(const CurveLobes<double>& lobes, int samples, std::uint64_t seed);

struct SampledMean {
  Rgb<double> mean;
  Rgb<double> standard_error;
};

// Mean of f_cos / pdf over sampled directions: the albedo.
SampledMean sampled_albedo(const CurveLobes<double>& lobes, int samples, std::uint64_t seed);

}  // namespace renderer
