// The texels of a baked cloth as a glTF surface that shows the same under even light.
//
// Highlight and sheen are the material's, tinted with the texel's own hue as far as the material says, and weaker where
// the texel sends back little light, in the valleys between yarns: they make at most half of that light. The two
// diffuse colours are what remains. So, seen straight on, a texel sends back and lets through as much even light as the
// renderer found, colour by colour.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "station/cloth/export/cloth_bake.h"
#include "station/cloth/export/gltf_brdf.h"

namespace station {

struct DiffuseColors {
  Eigen::Array3d reflected = Eigen::Array3d::Zero(), transmitted = Eigen::Array3d::Zero();  // linear; sum at most 1
};

struct PbrTexel {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, as shaded: already scaled by normal_scale
  double opacity = 1;
  GltfGloss gloss{};
  DiffuseColors diffuse{};
};

// The unit normal after x and y of a map's normal are multiplied by `scale`.
Eigen::Vector3d scaled_normal(const cv::Vec3f& normal, double scale);

// A material seen straight on under light of radiance 1 from all directions above the picture's plane, or below it.
class EvenLight {
 public:
  explicit EvenLight(const GltfShader& shader);

  struct Seen {
    Eigen::Array3d reflectance, transmittance;
  };
  Seen seen(const PbrTexel& texel) const;
  // Sets gloss and colours so that the texel shows `wanted`. A slanted texel reflects light from behind and lets light
  // from the front through; where that is more than is wanted, its normal is raised until it is not.
  void fit(const Seen& wanted, PbrTexel& texel) const;

 private:
  struct Response {
    GltfShader::Lobes above{}, below{};  // for light from above and from below
  };
  Response at(double normal_z, double strength) const;
  bool fit_colors(const Seen& wanted, PbrTexel& texel) const;  // returns whether exactly
  Seen gloss_seen(const Response& response, const GltfGloss& gloss) const;

  const GltfShader& shader_;
  std::vector<Response> responses_;  // by even steps of normal_z and, within each, of the strength; both from 0
};

// The texels at `across` x `across` evenly spread places of the side's picture; all texels where it has fewer.
std::vector<PbrTexel> texels_of(const BakedSide& side, const GltfShader& shader, int across);

// The mean of radiance(), in the unit of far_field(): pi x radiance over irradiance perpendicular to the light.
Eigen::Array3d mean_radiance(const std::vector<PbrTexel>& texels, const GltfShader& shader,
                             const Eigen::Vector3d& to_view, const Eigen::Vector3d& to_light);

Eigen::Array3d radiance(const PbrTexel& texel, const GltfShader& shader, const Eigen::Vector3d& to_view,
                        const Eigen::Vector3d& to_light);

}  // namespace station
