// Lobes shared by all curve scattering models: longitudinal M_p, azimuthal N_p, Fresnel, roughness maps.
//
// Local frame of a curve: x along the tangent, (y, z) the normal plane; theta is measured from the normal plane
// (sin theta = w.x), phi = atan2(w.z, w.y). Directions are unit and point away from the curve. `o` is the direction
// for which the offset h is known (while tracing: towards the viewer), `i` the other one. gamma_o = asin(h).
//
// Value convention: f_cos = sum_p M_p(theta_i, theta_o) N_p(phi) A_p, which contains the cosine and integrates to sum_p
// A_p over the sphere of directions i. Radiance is multiplied by f_cos / pdf, with no further cosine.
//
// Sources: d'Eon et al. 2011 (M_p), Chiang et al. 2015 (N_p, roughness maps). Everything is templated on the scalar
// S: float for rendering, packets of floats for many places at once (packet.h), double, or dual numbers for derivatives
// with respect to parameters.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "renderer/scattering/bessel.h"
#include "renderer/scattering/packet.h"
#include "renderer/scattering/select.h"

namespace renderer {

// One value per lobe. Models with fewer lobes leave the last values at zero. Packets (packet.h) calculate every lane in
// full and serve threads only, so they have three lobes.
template <class S>
inline constexpr int kLanes = 4;
template <int n>
inline constexpr int kLanes<Packet<n>> = 3;
template <class S>
using Lanes = Eigen::Array<S, kLanes<S>, 1>;
template <class T, class S>
Lanes<T> lanes_in(const Lanes<S>& lanes) {
  return lanes.template head<kLanes<T>>().template cast<T>();
}
template <class S>
using Rgb = Eigen::Array<S, 3, 1>;
template <class S>
using Vec3 = Eigen::Matrix<S, 3, 1>;

// The scalar of directions: S itself, or for a dual number the scalar that it is made of.
template <class S>
struct GeometryOf {
  using type = S;
};
template <class S>
requires requires {
  typename S::Scalar;
}
struct GeometryOf<S> {
  using type = typename S::Scalar;
};
template <class S>
using Geometry = typename GeometryOf<S>::type;

template <class S>
S power(const S& base, int exponent) {  // by squaring; exponent >= 0
  if (exponent == 0) return S(1.0);
  const S half = power<S>(base, exponent / 2);
  return exponent % 2 ? half * half * base : half * half;
}

// The variance v of the longitudinal lobe with this perceptual roughness in 0..1.
template <class S>
S longitudinal_variance(const S& beta_m) {
  const S root = S(0.726) * beta_m + S(0.812) * beta_m * beta_m + S(3.7) * power(beta_m, 20);
  return root * root;
}

// The scale s of the azimuthal logistic lobe with this perceptual roughness in 0..1.
template <class S>
S azimuthal_scale(const S& beta_n) {
  return S(std::sqrt(std::numbers::pi / 8)) *
         (S(0.265) * beta_n + S(1.194) * beta_n * beta_n + S(5.372) * power(beta_n, 22));
}

// The unpolarised reflectance of a smooth dielectric seen from outside; cos_i in 0..1.
template <class S>
S fresnel_dielectric(const S& cos_i, const S& eta) {
  using std::sqrt;
  const S sin2_t = (S(1.0) - cos_i * cos_i) / (eta * eta);
  if (!(sin2_t < S(1.0))) return S(1.0);
  const S cos_t = sqrt(S(1.0) - sin2_t);
  const S parallel = (eta * cos_i - cos_t) * (cos_i + eta * cos_t);
  const S perpendicular = (cos_i - eta * cos_t) * (eta * cos_i + cos_t);
  const S both = (eta * cos_i + cos_t) * (cos_i + eta * cos_t);  // the common denominator: one division
  return S(0.5) * (parallel * parallel + perpendicular * perpendicular) / (both * both);
}

// The straight way through the fiber after the first refraction, with the effective index eta' of the normal plane
// (Bravais).
template <class S>
struct InnerChord {
  S gamma_t;
  S length;  // in fiber radii

  InnerChord(const Geometry<S>& h, const Geometry<S>& sin_theta, const Geometry<S>& cos_theta, const S& eta) {
    using std::asin, std::sqrt;
    const S inside2 = eta * eta - S(sin_theta * sin_theta);  // (eta cos theta_t)^2
    const S sin_gamma_t = S(h * cos_theta) / sqrt(inside2);  // h / eta'
    gamma_t = asin(sin_gamma_t);
    length = S(2.0) * eta * sqrt((S(1.0) - sin_gamma_t * sin_gamma_t) / inside2);
  }
};

// The azimuth of the centre of lobe p relative to phi_o, within [-pi, pi].
template <class S>
S lobe_center(int p, const S& gamma_o, const S& gamma_t) {
  using std::floor;
  const S center = S(2.0 * p) * gamma_t - S(2.0) * gamma_o + S(p * std::numbers::pi);
  return center - S(2 * std::numbers::pi) * floor((center + S(std::numbers::pi)) * S(0.5 / std::numbers::pi));
}

// The lobes' widths, with everything computed that depends on them but not on directions.
template <class S>
struct LobeWidths {
  Lanes<S> v, s;  // longitudinal variance, azimuthal scale
  Lanes<S> inv_v, inv_s;
  Lanes<S> m_span;          // 1 - exp(-2 / v)
  Lanes<S> m_norm, n_norm;  // 1 / (v m_span); 1 / (s tanh(pi / 2s))
  Lanes<S> n_span;          // tanh(pi / 2s)

  void set(int p, const S& variance, const S& scale) {
    using std::expm1, std::tanh;
    v[p] = variance;
    inv_v[p] = S(1.0) / variance;
    m_span[p] = -expm1(S(-2.0) * inv_v[p]);
    m_norm[p] = inv_v[p] / m_span[p];
    s[p] = scale;
    inv_s[p] = S(1.0) / scale;
    n_span[p] = tanh(S(std::numbers::pi / 2) * inv_s[p]);
    n_norm[p] = inv_s[p] / n_span[p];
  }
  // Makes lobe p uniform in azimuth, which is the logistic's limit for large s, in the form that needs no limit.
  void set_uniform_azimuth(int p, const S& variance) {
    set(p, variance, S(1.0));
    inv_s[p] = S(0.0);
    n_norm[p] = S(2.0 / std::numbers::pi);
  }
  template <class T>
  LobeWidths<T> cast() const {
    return {lanes_in<T, S>(v),      lanes_in<T, S>(s),      lanes_in<T, S>(inv_v),  lanes_in<T, S>(inv_s),
            lanes_in<T, S>(m_span), lanes_in<T, S>(m_norm), lanes_in<T, S>(n_norm), lanes_in<T, S>(n_span)};
  }
};

// Where direction i lies relative to each lobe: all that M_p and N_p depend on besides the widths.
template <class S>
struct LobeAngles {
  Lanes<S> distance2;    // squared distance of the directions across the specular cone, in (cos theta, sin theta)
  Lanes<S> cos_cos;      // cos theta_o cos theta_i
  Lanes<S> from_center;  // |phi - Phi_p|, within [0, pi]
};

// The longitudinal M = exp(-b) I0(a) / (2 v sinh(1/v)) of each lobe, with a = cos cos / v and b = sin sin / v. The
// exponentials are merged into the squared distance of the two directions across the specular cone, which stays exact
// in float for small v.
template <class S>
Lanes<S> longitudinal_density(const LobeWidths<S>& widths, const LobeAngles<S>& at) {
  const auto bessel = bessel_i0e(Lanes<S>(at.cos_cos * widths.inv_v));
  return widths.m_norm * bessel.factor * (at.distance2 * widths.inv_v * S(-0.5) - bessel.exponent).exp();
}

// The azimuthal N of each lobe: the logistic around its centre, trimmed to [-pi, pi].
template <class S>
Lanes<S> azimuthal_density(const LobeWidths<S>& widths, const LobeAngles<S>& at) {
  const Lanes<S> e = (-at.from_center * widths.inv_s).exp();
  return widths.n_norm * e / (e + S(1.0)).square();
}

template <class S>
struct ScatteringValue {
  Rgb<S> f_cos;  // includes the cosine
  S pdf;         // density of sampling this direction, per solid angle
};

// The lobes as seen from one direction o with offset h; made by a model (fiber.h) once per hit, then evaluated and
// sampled as often as wanted. They refer to the model's widths and must not outlive the model.
template <class S>
struct CurveLobes {
  using G = Geometry<S>;

  const LobeWidths<S>* widths = nullptr;
  Eigen::Matrix<G, 2, 1> azimuth_o;           // unit (y, z) of direction o
  Lanes<S> sin_theta_o, cos_theta_o;          // after the cuticle tilt
  Lanes<S> center;                            // Phi_p, within [-pi, pi]
  Eigen::Array<S, kLanes<S>, 3> attenuation;  // A_p, RGB
  Lanes<S> probability;                       // of choosing lobe p when sampling; sums to 1

  void set_azimuth(const Vec3<G>& wo) {
    using std::sqrt;
    const G radial = sqrt(wo.y() * wo.y() + wo.z() * wo.z());
    const auto across = radial > G(0);  // else along the curve, where every azimuth is right
    azimuth_o = {select(across, G(wo.y() / radial), G(0)), select(across, G(wo.z() / radial), G(1))};
  }

  void empty_lanes_from(int first) {
    for (int p = first; p < kLanes<S>; ++p) {
      center[p] = probability[p] = S(0.0);
      attenuation.row(p).setConstant(S(0.0));
    }
  }

  ScatteringValue<S> evaluate(const Vec3<G>& wi) const {
    const Lanes<S> density = lobe_densities(wi);
    ScatteringValue<S> value;
    for (int c = 0; c < 3; ++c) value.f_cos[c] = (density * attenuation.col(c)).sum();
    value.pdf = (density * probability).sum();
    return value;
  }

  // M_p N_p of each lobe, its density over solid angle.
  Lanes<S> lobe_densities(const Vec3<G>& wi) const {
    const LobeAngles<S> at = angles(wi);
    return longitudinal_density(*widths, at) * azimuthal_density(*widths, at);
  }

  LobeAngles<S> angles(const Vec3<G>& wi) const {
    using std::atan2, std::sqrt;
    const G cos_theta_i = sqrt(wi.y() * wi.y() + wi.z() * wi.z());
    const G along = azimuth_o.x() * wi.y() + azimuth_o.y() * wi.z();
    const G across = azimuth_o.x() * wi.z() - azimuth_o.y() * wi.y();
    const Lanes<S> straight = (center - S(atan2(across, along))).abs();
    return {.distance2 = (cos_theta_o - S(cos_theta_i)).square() + (sin_theta_o + S(wi.x())).square(),
            .cos_cos = cos_theta_o * S(cos_theta_i),
            .from_center = straight.min(Lanes<S>(S(2 * std::numbers::pi) - straight))};
  }

  // A random direction i, drawn with the density evaluate(i).pdf; all u in [0, 1).
  Vec3<G> sample(const S& u_lobe, const S& u_theta, const S& u_ring, const S& u_phi) const {
    using std::cos, std::sin, std::sqrt;
    const int p = choose_lobe(u_lobe);
    const S sin_theta_i = sample_longitudinal(p, u_theta, u_ring);
    const S cos_theta_i = sqrt(S(1.0) - sin_theta_i * sin_theta_i);
    const S phi = center[p] + sample_azimuthal(p, u_phi);
    const S c = cos(phi) * cos_theta_i, s = sin(phi) * cos_theta_i;
    return {sin_theta_i, azimuth_o.x() * c - azimuth_o.y() * s, azimuth_o.x() * s + azimuth_o.y() * c};
  }

  int choose_lobe(S u) const {
    for (int p = 0; p < 3; ++p) {
      if (u < probability[p]) return p;
      u -= probability[p];
    }
    return probability[3] > S(0.0) ? 3 : 0;  // rounding can leave a little u over for models of three lobes
  }

  // A random sin theta_i of lobe p, from an angle to the specular direction and a position on the ring at that angle
  // (d'Eon 2013).
  S sample_longitudinal(int p, const S& u_theta, const S& u_ring) const {
    using std::cos, std::log1p, std::sqrt;
    S one_minus_cos = -widths->v[p] * log1p(-(S(1.0) - u_theta) * widths->m_span[p]);
    if (!(one_minus_cos < S(2.0))) one_minus_cos = S(2.0);
    const S sine = sqrt(one_minus_cos * (S(2.0) - one_minus_cos));
    const S sin_theta_i =
        (one_minus_cos - S(1.0)) * sin_theta_o[p] + sine * cos(S(2 * std::numbers::pi) * u_ring) * cos_theta_o[p];
    if (sin_theta_i > S(1.0)) return S(1.0);
    return sin_theta_i < S(-1.0) ? S(-1.0) : sin_theta_i;
  }

  S sample_azimuthal(int p, const S& u) const {
    using std::log;
    const S centered = S(2.0) * u - S(1.0);
    if (widths->inv_s[p] == S(0.0)) return S(std::numbers::pi) * centered;
    const S t = centered * widths->n_span[p];
    const S x = widths->s[p] * log((S(1.0) + t) / (S(1.0) - t));
    if (x > S(std::numbers::pi)) return S(std::numbers::pi);
    return x < S(-std::numbers::pi) ? S(-std::numbers::pi) : x;
  }
};

}  // namespace renderer
