// The shading of a surface in glTF 2.0: a dielectric with a specular and a diffuse part (specification, appendix B,
// without metal), and on it the ratified extensions that suit cloth: KHR_materials_specular (strength and colour of the
// highlight), KHR_materials_sheen (Charlie distribution and visibility of Conty and Kulla 2017, base layer dimmed by
// albedo scaling) and KHR_materials_diffuse_transmission (light that comes through evenly; KHR_materials_transmission
// would be clear as glass).
//
// Directions are unit and leave the surface; colours are linear RGB. Light from behind is mirrored at the surface
// before the Fresnel term is taken, as Khronos' own viewer does; the specification leaves that open.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace station {

// The parameters that are the same all over a cloth.
struct GltfMaterial {
  double roughness = 1;          // perceptual: alpha = roughness^2
  double specular = 1;           // specularFactor of a texel at full strength
  double specular_level = 1;     // specularColorFactor; 0.04 times it is the reflectance at normal incidence
  double specular_tint = 0;      // 0: white highlights, 1: of the texel's hue
  double sheen = 0;              // sheenColorFactor, at most 1
  double sheen_tint = 0;         // the same for the sheen
  double sheen_roughness = 0.5;  // perceptual, as `roughness`
  double normal_scale = 1;       // factor of the normal map's x and y
};

// The highlight and sheen of a texel; colours are linear, and their largest channel is 1.
struct GltfGloss {
  double strength = 1;  // strength of both, in [0, 1]
  Eigen::Array3d specular_color = Eigen::Array3d::Ones(), sheen_color = Eigen::Array3d::Ones();
};

// The gloss at full strength of a texel of that hue (largest channel 1).
GltfGloss gloss_of(const GltfMaterial& material, const Eigen::Array3d& hue);

inline constexpr double kLeastRoughness = 0.05, kLeastSheenRoughness = 0.1;

// The Charlie distribution, per solid angle, of the normals of hairs that stand on end; alpha = sheen_roughness^2.
double charlie_distribution(double cos_half, double alpha);
// Its shadowing and masking, with the microfacet model's 1 / (4 cos cos).
double charlie_visibility(double cos_view, double cos_light, double alpha);

// The share of light that a white sheen sends back, by the cosine of the angle at which the light falls in.
class SheenAlbedo {
 public:
  explicit SheenAlbedo(double sheen_roughness);
  double at(double cosine) const;

 private:
  std::vector<double> values_;  // at even steps of the cosine, 0 first
};

// A material made ready for many evaluations.
class GltfShader {
 public:
  explicit GltfShader(const GltfMaterial& material);

  // The parts of the radiance for light of irradiance pi perpendicular to its direction, cosine and density included.
  struct Lobes {
    double facing = 0;       // to be multiplied by the gloss's specular colour
    double grazing = 0;      // white
    double sheen = 0;        // to be multiplied by the gloss's sheen colour
    double reflected = 0;    // to be multiplied by the diffuse colour that is reflected
    double transmitted = 0;  // to be multiplied by the diffuse colour that is let through
  };
  Lobes lobes(const Eigen::Vector3d& normal, const Eigen::Vector3d& to_view, const Eigen::Vector3d& to_light,
              double strength) const;

  // The radiance of highlight and sheen.
  Eigen::Array3d radiance(const Lobes& lobes, const GltfGloss& gloss) const;

  const GltfMaterial& material() const { return material_; }

 private:
  GltfMaterial material_;
  double facing_reflectance_;  // at normal incidence, in the strongest colour
  SheenAlbedo sheen_albedo_;
};

}  // namespace station
