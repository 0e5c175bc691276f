#include "station/export/pbr_texels.h"

#include <algorithm>
#include <cmath>

namespace station {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;
constexpr int kNormalSteps = 24;
constexpr double kLeastOpacity = 1e-3;

Array3d array_of(const cv::Vec3f& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace

Vector3d scaled_normal(const cv::Vec3f& normal, double scale) {
  return Vector3d(scale * normal[0], scale * normal[1], std::max(0.05f, normal[2])).normalized();
}

// Midpoints of equal parts of the sphere; half a circle is enough, the other half is its mirror image.
EvenLight::EvenLight(const GltfShader& shader) {
  constexpr int kPolar = 32, kAzimuths = 16;
  for (int i = 0; i <= kNormalSteps; ++i) {
    const double normal_z = static_cast<double>(i) / kNormalSteps;
    const Vector3d normal(std::sqrt(1 - normal_z * normal_z), 0, normal_z);
    Response sum;
    for (int p = 0; p < kPolar; ++p) {
      const double z = 1 - 2 * (p + 0.5) / kPolar, sine = std::sqrt(1 - z * z);
      for (int k = 0; k < kAzimuths; ++k) {
        const double phi = kPi * (k + 0.5) / kAzimuths;
        const Vector3d light(sine * std::cos(phi), sine * std::sin(phi), z);
        const GltfShader::Shading shading = shader.shade(normal, Vector3d::UnitZ(), light);
        (z > 0 ? sum.fixed_above : sum.fixed_below) += shading.fixed;
        (z > 0 ? sum.above_reflected : sum.below_reflected) += shading.reflected;
        (z > 0 ? sum.above_transmitted : sum.below_transmitted) += shading.transmitted;
      }
    }
    constexpr double kWeight = 4.0 / (kPolar * kAzimuths);  // solid angle of each, over pi
    sum.fixed_above *= kWeight, sum.fixed_below *= kWeight;
    sum.above_reflected *= kWeight, sum.above_transmitted *= kWeight;
    sum.below_reflected *= kWeight, sum.below_transmitted *= kWeight;
    responses_.push_back(sum);
  }
}

EvenLight::Response EvenLight::at(double normal_z) const {
  const double place = std::clamp(normal_z, 0.0, 1.0) * kNormalSteps;
  const auto below = static_cast<std::size_t>(std::min(place, kNormalSteps - 1.0));
  const double w = place - static_cast<double>(below);
  const Response &a = responses_[below], &b = responses_[below + 1];
  return {.fixed_above = a.fixed_above + w * (b.fixed_above - a.fixed_above),
          .fixed_below = a.fixed_below + w * (b.fixed_below - a.fixed_below),
          .above_reflected = a.above_reflected + w * (b.above_reflected - a.above_reflected),
          .above_transmitted = a.above_transmitted + w * (b.above_transmitted - a.above_transmitted),
          .below_reflected = a.below_reflected + w * (b.below_reflected - a.below_reflected),
          .below_transmitted = a.below_transmitted + w * (b.below_transmitted - a.below_transmitted)};
}

EvenLight::Seen EvenLight::seen(const DiffuseColors& diffuse, double normal_z) const {
  const Response r = at(normal_z);
  return {r.fixed_above + r.above_reflected * diffuse.reflected + r.above_transmitted * diffuse.transmitted,
          r.fixed_below + r.below_reflected * diffuse.reflected + r.below_transmitted * diffuse.transmitted};
}

DiffuseColors EvenLight::diffuse_for(const Seen& wanted, double normal_z) const {
  const Response r = at(normal_z);
  const Array3d above = wanted.reflectance - r.fixed_above, below = wanted.transmittance - r.fixed_below;
  const double determinant = r.above_reflected * r.below_transmitted - r.above_transmitted * r.below_reflected;
  DiffuseColors diffuse{(r.below_transmitted * above - r.above_transmitted * below) / determinant,
                        (r.above_reflected * below - r.below_reflected * above) / determinant};
  diffuse.reflected = diffuse.reflected.max(0).min(1);
  diffuse.transmitted = diffuse.transmitted.max(0).min(1);
  const double excess = (diffuse.reflected + diffuse.transmitted).maxCoeff();
  if (excess > 1) diffuse.reflected /= excess, diffuse.transmitted /= excess;
  return diffuse;
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
        texel.diffuse = even.diffuse_for({array_of(side.reflectance(row, column)) / texel.opacity,
                                          array_of(side.transmittance(row, column)) / texel.opacity},
                                         texel.normal.z());
      texels.push_back(texel);
    }
  return texels;
}

Array3d radiance(const PbrTexel& texel, const GltfShader& shader, const Vector3d& to_view, const Vector3d& to_light) {
  const GltfShader::Shading shading = shader.shade(texel.normal, to_view, to_light);
  return texel.opacity * (shading.fixed + shading.reflected * texel.diffuse.reflected +
                          shading.transmitted * texel.diffuse.transmitted);
}

Array3d mean_radiance(const std::vector<PbrTexel>& texels, const GltfShader& shader, const Vector3d& to_view,
                      const Vector3d& to_light) {
  Array3d sum = Array3d::Zero();
  for (const PbrTexel& texel : texels) sum += radiance(texel, shader, to_view, to_light);
  return sum / static_cast<double>(texels.size());
}

}  // namespace station
