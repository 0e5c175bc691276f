// Statistics that judge any curve scattering model: its energy by quadrature and by sampling, its sampling against its
// density, and whether it stays finite where that is hardest.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "renderer/scattering/lobes.h"

namespace renderer {

// A unit direction in the local frame of lobes.h.
Vec3<double> direction(double theta, double phi);
// The direction o for an offset h when the surface normal is along the local z axis: phi_o = pi/2 + asin(h).
Vec3<double> viewing_direction(double theta, double h);

// The integral of f_cos over the sphere, by quadrature: the white furnace.
Rgb<double> energy(const CurveLobes<double>& lobes);

// The p-value of a chi-square test of sampling: the probability of at least this disagreement between `samples` sampled
// directions and the density, if they agree. The bins are quantiles of the density, so that narrow lobes are resolved
// as well as wide ones.
double sampling_p_value(const CurveLobes<double>& lobes, int samples, std::uint64_t seed);

// Tests, lobe by lobe, of the law that the density is one over the Jacobian of the sampling map. Azimuth comes from one
// random number: the first returns the largest |N dphi/du - 1|. Inclination comes from two: the second returns the
// largest difference between the probability of sampling sin theta below a limit, found from the map alone, and the
// integral of M up to it.
double azimuth_map_error(const CurveLobes<double>& lobes, int p);
double inclination_map_error(const CurveLobes<double>& lobes, int p);

struct SampledMean {
  Rgb<double> mean;
  Rgb<double> standard_error;
  double least_weight, greatest_weight;  // f_cos / pdf, mean over the channels
};

// The mean of f_cos / pdf over sampled directions, which is the albedo.
SampledMean sampled_albedo(const CurveLobes<double>& lobes, int samples, std::uint64_t seed);

// Whether values, densities and samples are finite for the lobes that `lobes_at(h, wo)` returns, at grazing offsets and
// inclinations and along the curve.
template <class S, class Function>
bool finite_everywhere(const Function& lobes_at) {
  bool finite = true;
  for (const double h : {-1.0, 0.0, 1.0}) {
    for (const double theta : {-std::numbers::pi / 2, -1.5707, 0.0, 1.57, std::numbers::pi / 2}) {
      Vec3<S> wo = viewing_direction(theta, h).template cast<S>();
      if (theta == std::numbers::pi / 2) wo = Vec3<S>::UnitX();  // without the rounding of the cosine
      const CurveLobes<S> lobes = lobes_at(static_cast<S>(h), wo);
      finite &= std::abs(static_cast<double>(lobes.probability.sum()) - 1) < 1e-5;
      for (const Vec3<S>& wi : {Vec3<S>(1, 0, 0), Vec3<S>(-1, 0, 0), Vec3<S>(0, 0, 1), Vec3<S>(-wo), wo}) {
        const ScatteringValue<S> value = lobes.evaluate(wi);
        finite &= value.f_cos.isFinite().all() && (value.f_cos >= S(0)).all();
        finite &= std::isfinite(value.pdf) && value.pdf >= S(0);
      }
      for (const S u : {S(0), std::nextafter(S(1), S(0))}) finite &= lobes.sample(u, u, u, u).allFinite();
    }
  }
  return finite;
}

}  // namespace renderer
