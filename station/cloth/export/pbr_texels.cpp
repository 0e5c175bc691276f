#include "station/cloth/export/pbr_texels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace station {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;
constexpr int kNormalSteps = 16, kStrengthSteps = 4;
constexpr double kLeastOpacity = 1e-3;

Array3d array_of(const cv::Vec3f& v) {
  return {v[0], v[1], v[2]};
}

void add(GltfShader::Lobes& sum, double weight, const GltfShader::Lobes& lobes) {
  sum.facing += weight * lobes.facing;
  sum.grazing += weight * lobes.grazing;
  sum.sheen += weight * lobes.sheen;
  sum.reflected += weight * lobes.reflected;
  sum.transmitted += weight * lobes.transmitted;
}

}  // namespace

Vector3d scaled_normal(const cv::Vec3f& normal, double scale) {
  return Vector3d(scale * normal[0], scale * normal[1], std::max(0.05f, normal[2])).normalized();
}

// Sums over the midpoints of equal parts of the sphere; half a circle is enough, the other half is its mirror image.
EvenLight::EvenLight(const GltfShader& shader) : shader_(shader) {
  constexpr int kPolar = 32, kAzimuths = 16;
  constexpr double kWeight = 4.0 / (kPolar * kAzimuths);  // solid angle of each, over pi
  for (int i = 0; i <= kNormalSteps; ++i)
    for (int s = 0; s <= kStrengthSteps; ++s) {
      const double normal_z = static_cast<double>(i) / kNormalSteps, strength = static_cast<double>(s) / kStrengthSteps;
      const Vector3d normal(std::sqrt(1 - normal_z * normal_z), 0, normal_z);
      Response sum;
      for (int p = 0; p < kPolar; ++p) {
        const double z = 1 - 2 * (p + 0.5) / kPolar, sine = std::sqrt(1 - z * z);
        for (int k = 0; k < kAzimuths; ++k) {
          const double phi = std::numbers::pi * (k + 0.5) / kAzimuths;
          const Vector3d light(sine * std::cos(phi), sine * std::sin(phi), z);
          add(z > 0 ? sum.above : sum.below, kWeight, shader.lobes(normal, Vector3d::UnitZ(), light, strength));
        }
      }
      responses_.push_back(sum);
    }
}

EvenLight::Response EvenLight::at(double normal_z, double strength) const {
  const double i = std::clamp(normal_z, 0.0, 1.0) * kNormalSteps, s = std::clamp(strength, 0.0, 1.0) * kStrengthSteps;
  const int i0 = std::min(static_cast<int>(i), kNormalSteps - 1),
            s0 = std::min(static_cast<int>(s), kStrengthSteps - 1);
  Response sum;
  for (const int di : {0, 1})
    for (const int ds : {0, 1}) {
      const double weight = (di == 1 ? i - i0 : 1 - i + i0) * (ds == 1 ? s - s0 : 1 - s + s0);
      const Response& node = responses_[static_cast<std::size_t>((i0 + di) * (kStrengthSteps + 1) + s0 + ds)];
      add(sum.above, weight, node.above);
      add(sum.below, weight, node.below);
    }
  return sum;
}

EvenLight::Seen EvenLight::gloss_seen(const Response& response, const GltfGloss& gloss) const {
  return {shader_.radiance(response.above, gloss), shader_.radiance(response.below, gloss)};
}

EvenLight::Seen EvenLight::seen(const PbrTexel& texel) const {
  const Response r = at(texel.normal.z(), texel.gloss.strength);
  const Seen gloss = gloss_seen(r, texel.gloss);
  const DiffuseColors& diffuse = texel.diffuse;
  return {gloss.reflectance + r.above.reflected * diffuse.reflected + r.above.transmitted * diffuse.transmitted,
          gloss.transmittance + r.below.reflected * diffuse.reflected + r.below.transmitted * diffuse.transmitted};
}

void EvenLight::fit(const Seen& wanted, PbrTexel& texel) const {
  const Vector3d normal = texel.normal;
  for (const double lean : {1.0, 0.75, 0.5, 0.25, 0.0}) {
    texel.normal = Vector3d(lean * normal.x(), lean * normal.y(), normal.z()).normalized();
    if (fit_colors(wanted, texel)) return;
  }
}

bool EvenLight::fit_colors(const Seen& wanted, PbrTexel& texel) const {
  constexpr double kMostGloss = 0.5;  // of what the texel sends back
  constexpr double kSlack = 2e-3;
  const Array3d color = wanted.reflectance.max(0);
  const Array3d hue = color.maxCoeff() > 0 ? Array3d(color / color.maxCoeff()) : Array3d::Ones();
  texel.gloss = gloss_of(shader_.material(), hue);
  const Seen full = gloss_seen(at(texel.normal.z(), 1), texel.gloss);
  texel.gloss.strength = std::min(1.0, (kMostGloss * color / full.reflectance.max(1e-9)).minCoeff());
  const Response r = at(texel.normal.z(), texel.gloss.strength);
  const Seen gloss = gloss_seen(r, texel.gloss);
  const Array3d above = wanted.reflectance - gloss.reflectance, below = wanted.transmittance - gloss.transmittance;
  const double determinant = r.above.reflected * r.below.transmitted - r.above.transmitted * r.below.reflected;
  const DiffuseColors exact{(r.below.transmitted * above - r.above.transmitted * below) / determinant,
                            (r.above.reflected * below - r.below.reflected * above) / determinant};
  texel.diffuse = {exact.reflected.max(0).min(1), exact.transmitted.max(0).min(1)};
  const double excess = (texel.diffuse.reflected + texel.diffuse.transmitted).maxCoeff();
  if (excess > 1) texel.diffuse.reflected /= excess, texel.diffuse.transmitted /= excess;
  return std::min(exact.reflected.minCoeff(), exact.transmitted.minCoeff()) >= -kSlack && excess <= 1 + kSlack;
}

std::vector<PbrTexel> texels_of(const BakedSide& side, const GltfShader& shader, int across) {
  const EvenLight even(shader);
  const int columns = std::min(across, side.opacity.cols), rows = std::min(across, side.opacity.rows);
  std::vector<PbrTexel> texels;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int row = (2 * j + 1) * side.opacity.rows / (2 * rows),
                column = (2 * i + 1) * side.opacity.cols / (2 * columns);
      PbrTexel texel{.normal = scaled_normal(side.normal(row, column), shader.material().normal_scale),
                     .opacity = side.opacity(row, column)};
      if (texel.opacity > kLeastOpacity)
        even.fit({array_of(side.reflectance(row, column)) / texel.opacity,
                  array_of(side.transmittance(row, column)) / texel.opacity},
                 texel);
      texels.push_back(texel);
    }
  return texels;
}

Array3d radiance(const PbrTexel& texel, const GltfShader& shader, const Vector3d& to_view, const Vector3d& to_light) {
  const GltfShader::Lobes lobes = shader.lobes(texel.normal, to_view, to_light, texel.gloss.strength);
  return texel.opacity * (shader.radiance(lobes, texel.gloss) + lobes.reflected * texel.diffuse.reflected +
                          lobes.transmitted * texel.diffuse.transmitted);
}

Array3d mean_radiance(const std::vector<PbrTexel>& texels, const GltfShader& shader, const Vector3d& to_view,
                      const Vector3d& to_light) {
  Array3d sum = Array3d::Zero();
  for (const PbrTexel& texel : texels) sum += radiance(texel, shader, to_view, to_light);
  return sum / static_cast<double>(texels.size());
}

}  // namespace station
