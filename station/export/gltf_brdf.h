// How glTF 2.0 shades a surface: a dielectric with a specular and a diffuse part (specification, appendix B, without metal),
// and on it the ratified extensions that suit cloth: KHR_materials_specular (strength and colour of the highlight),
// KHR_materials_sheen (Charlie distribution and visibility of Conty and Kulla 2017, base layer dimmed by albedo scaling) and
// KHR_materials_diffuse_transmission (light that comes through evenly; KHR_materials_transmission would be clear as glass).
//
// Directions are unit and leave the surface; colours are linear RGB. Light from behind is mirrored at the surface before the
// Fresnel term is taken, as Khronos' own viewer does; the specification leaves that open.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace station {

// What is the same all over a cloth.
struct GltfMaterial {
  double roughness = 1;                                    // perceptual: alpha = roughness^2
  double specular = 1;                                     // specularFactor
  Eigen::Array3d specular_color = Eigen::Array3d::Ones();  // times 0.04: reflectance at normal incidence, at most 1
  Eigen::Array3d sheen_color = Eigen::Array3d::Zero();     // in [0, 1]
  double sheen_roughness = 0.5;                            // perceptual, as above
  double normal_scale = 1;                                 // of the normal map's x and y
};

inline constexpr double kLeastRoughness = 0.05, kLeastSheenRoughness = 0.1;

// Distribution of the normals of hair on end, per solid angle; alpha = sheen_roughness^2.
double charlie_distribution(double cos_half, double alpha);
// Shadowing and masking of it, with the microfacet model's 1 / (4 cos cos).
double charlie_visibility(double cos_view, double cos_light, double alpha);

// Share of the light that a white sheen sends back from light that falls in under a given angle.
class SheenAlbedo {
 public:
  explicit SheenAlbedo(double sheen_roughness);
  double at(double cosine) const;

 private:
  std::vector<double> values_;  // at even steps of the cosine, 0 first
};

// The material ready for many evaluations.
class GltfShader {
 public:
  explicit GltfShader(const GltfMaterial& material);

  // Radiance = `fixed` + `reflected` x diffuse colour that is reflected + `transmitted` x that which is let through, for light
  // of irradiance pi perpendicular to its direction: cosine and density are in it.
  struct Shading {
    Eigen::Array3d fixed = Eigen::Array3d::Zero();
    double reflected = 0, transmitted = 0;
  };
  Shading shade(const Eigen::Vector3d& normal, const Eigen::Vector3d& to_view, const Eigen::Vector3d& to_light) const;

  const GltfMaterial& material() const { return material_; }

 private:
  double base_share(double cos_view, double cos_light) const;

  GltfMaterial material_;
  Eigen::Array3d f0_;
  SheenAlbedo sheen_albedo_;
};

}  // namespace station
