#include "station/cloth/export/gltf_brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace station {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;
constexpr double kLeastCosine = 1e-3;  // of grazing views, which normal maps produce even below the horizon
constexpr int kAlbedoSteps = 64;
constexpr double kDielectric = 0.04;  // reflectance at normal incidence

double ggx_distribution(double cos_half, double alpha) {
  const double a2 = alpha * alpha, d = cos_half * cos_half * (a2 - 1) + 1;
  return a2 / (std::numbers::pi * d * d);
}

// Smith's separable shadowing and masking, with the microfacet model's 1 / (4 cos cos).
double ggx_visibility(double cos_view, double cos_light, double alpha) {
  const double a2 = alpha * alpha;
  const auto side = [a2](double cosine) { return 1 / (cosine + std::sqrt(a2 + (1 - a2) * cosine * cosine)); };
  return side(cos_view) * side(cos_light);
}

// The lambda that Conty and Kulla 2017 fitted to the distribution.
double charlie_lambda(double cosine, double alpha) {
  const double smooth = (1 - alpha) * (1 - alpha);
  const auto mix = [smooth](double rough_value, double smooth_value) {
    return rough_value + smooth * (smooth_value - rough_value);
  };
  const double a = mix(21.5473, 25.3245), b = mix(3.82987, 3.32435), c = mix(0.19823, 0.16801),
               d = mix(-1.97760, -1.27393), e = mix(-4.32054, -4.85967);
  const auto l = [&](double x) { return a / (1 + b * std::pow(x, c)) + d * x + e; };
  return cosine < 0.5 ? std::exp(l(cosine)) : std::exp(2 * l(0.5) - l(1 - cosine));
}

}  // namespace

double charlie_distribution(double cos_half, double alpha) {
  const double sin2 = std::max(0.0, 1 - cos_half * cos_half);
  return (2 + 1 / alpha) * std::pow(sin2, 0.5 / alpha) / (2 * std::numbers::pi);
}

double charlie_visibility(double cos_view, double cos_light, double alpha) {
  return 1 / ((1 + charlie_lambda(cos_view, alpha) + charlie_lambda(cos_light, alpha)) * 4 * cos_view * cos_light);
}

// E(v) = integral of D V cos over the hemisphere of light, by the midpoint rule in cos^2 / 2 and azimuth.
SheenAlbedo::SheenAlbedo(double sheen_roughness) {
  constexpr int kPolar = 24, kAzimuths = 24;
  const double alpha = std::pow(std::max(sheen_roughness, kLeastSheenRoughness), 2);
  for (int i = 0; i <= kAlbedoSteps; ++i) {
    const double cos_view = std::max(kLeastCosine, static_cast<double>(i) / kAlbedoSteps);
    const Vector3d view(std::sqrt(1 - cos_view * cos_view), 0, cos_view);
    double sum = 0;
    for (int p = 0; p < kPolar; ++p) {
      const double cos_light = std::sqrt((p + 0.5) / kPolar), sine = std::sqrt(1 - cos_light * cos_light);
      const double visibility = charlie_visibility(cos_view, cos_light, alpha);
      for (int k = 0; k < kAzimuths; ++k) {  // half a circle: the other half is its mirror image
        const double phi = std::numbers::pi * (k + 0.5) / kAzimuths;
        const Vector3d half = (view + Vector3d(sine * std::cos(phi), sine * std::sin(phi), cos_light)).normalized();
        sum += charlie_distribution(half.z(), alpha) * visibility;
      }
    }
    values_.push_back(sum * std::numbers::pi / (kPolar * kAzimuths));
  }
}

double SheenAlbedo::at(double cosine) const {
  const double place = std::clamp(cosine, 0.0, 1.0) * kAlbedoSteps;
  const auto below = static_cast<std::size_t>(std::min(place, kAlbedoSteps - 1.0));
  const double within = place - static_cast<double>(below);
  return values_[below] + within * (values_[below + 1] - values_[below]);
}

GltfGloss gloss_of(const GltfMaterial& material, const Array3d& hue) {
  const auto tinted = [&hue](double tint) -> Array3d { return 1 - tint + tint * hue; };
  return {.specular_color = tinted(material.specular_tint), .sheen_color = tinted(material.sheen_tint)};
}

GltfShader::GltfShader(const GltfMaterial& material)
    : material_(material),
      facing_reflectance_(std::min(1.0, kDielectric * material.specular_level)),
      sheen_albedo_(material.sheen_roughness) {}

Array3d GltfShader::radiance(const Lobes& lobes, const GltfGloss& gloss) const {
  return lobes.facing * gloss.specular_color + lobes.grazing + lobes.sheen * gloss.sheen_color;
}

GltfShader::Lobes GltfShader::lobes(const Vector3d& normal, const Vector3d& to_view, const Vector3d& to_light,
                                    double strength) const {
  Lobes found;
  const double facing = normal.dot(to_light), cos_light = std::abs(facing);
  if (cos_light < 1e-9) return found;
  const double cos_view = std::max(kLeastCosine, normal.dot(to_view));
  const Vector3d front_light = facing > 0 ? to_light : Vector3d(to_light - 2 * facing * normal);
  const Vector3d half = (to_view + front_light).normalized();
  const double grazing = std::pow(1 - std::clamp(half.dot(to_view), 0.0, 1.0), 5),
               specular = strength * material_.specular;
  const double fresnel = specular * (facing_reflectance_ + (1 - facing_reflectance_) * grazing),
               sheen_share =
                   strength * material_.sheen * std::max(sheen_albedo_.at(cos_view), sheen_albedo_.at(cos_light)),
               base = std::max(0.0, 1 - sheen_share), diffuse = (1 - fresnel) * base * cos_light;
  if (facing < 0) {
    found.transmitted = diffuse;
    return found;
  }
  found.reflected = diffuse;
  const double cos_half = std::clamp(normal.dot(half), 0.0, 1.0), to_radiance = std::numbers::pi * cos_light;
  const double alpha = std::pow(std::max(material_.roughness, kLeastRoughness), 2);
  const double highlight =
      specular * base * to_radiance * ggx_distribution(cos_half, alpha) * ggx_visibility(cos_view, cos_light, alpha);
  found.facing = highlight * facing_reflectance_ * (1 - grazing);
  found.grazing = highlight * grazing;
  if (material_.sheen > 0) {
    const double sheen_alpha = std::pow(std::max(material_.sheen_roughness, kLeastSheenRoughness), 2);
    found.sheen = strength * material_.sheen * to_radiance * charlie_distribution(cos_half, sheen_alpha) *
                  charlie_visibility(cos_view, cos_light, sheen_alpha);
  }
  return found;
}

}  // namespace station
