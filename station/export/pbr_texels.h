// The texels of a baked cloth as a glTF surface that shows the same under even light.
//
// A texel's highlight and sheen are the material's; its two diffuse colours are what remains: seen straight on, it then sends
// back and lets through as much even light as the renderer found, texel by texel and colour by colour.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "station/export/cloth_bake.h"
#include "station/export/gltf_brdf.h"

namespace station {

struct DiffuseColors {
  Eigen::Array3d reflected = Eigen::Array3d::Zero(), transmitted = Eigen::Array3d::Zero();  // linear; sum at most 1
};

struct PbrTexel {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, as shaded: scaled by the material's normal_scale
  double opacity = 1;
  DiffuseColors diffuse{};
};

Eigen::Vector3d scaled_normal(const cv::Vec3f& normal, double scale);

// A material under light of radiance 1 from all directions above the picture's plane, or below it, seen straight on.
class EvenLight {
 public:
  explicit EvenLight(const GltfShader& shader);

  struct Seen {
    Eigen::Array3d reflectance, transmittance;
  };
  Seen seen(const DiffuseColors& diffuse, double normal_z) const;
  // The colours with which a surface shows `wanted`; those that it cannot have are cut to the range that it has.
  DiffuseColors diffuse_for(const Seen& wanted, double normal_z) const;

 private:
  struct Response {
    Eigen::Array3d fixed_above = Eigen::Array3d::Zero(), fixed_below = Eigen::Array3d::Zero();
    // By light from above and below, of the colour that is reflected and of the one that is let through.
    double above_reflected = 0, above_transmitted = 0, below_reflected = 0, below_transmitted = 0;
  };
  Response at(double normal_z) const;

  std::vector<Response> responses_;  // at even steps of normal_z, 0 first
};

// `across` x `across` texels of the side's picture, evenly spread; all of them where it has fewer.
std::vector<PbrTexel> texels_of(const BakedSide& side, const GltfShader& shader, int across);

// pi x mean radiance over irradiance perpendicular to the light, as cloth_far_field.h has it.
Eigen::Array3d mean_radiance(const std::vector<PbrTexel>& texels, const GltfShader& shader,
                             const Eigen::Vector3d& to_view, const Eigen::Vector3d& to_light);

Eigen::Array3d radiance(const PbrTexel& texel, const GltfShader& shader, const Eigen::Vector3d& to_view,
                        const Eigen::Vector3d& to_light);

}  // namespace station
