// The glTF material that comes nearest to a cloth seen from afar.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "station/cloth/export/cloth_far_field.h"
#include "station/cloth/export/pbr_texels.h"

namespace station {

// The error at one pair of directions; both colours are as far_field() has them.
struct FarFieldError {
  DirectionPair pair;
  Eigen::Array3d cloth, material;
  double delta_e = 0;  // CIEDE2000; white is a matt white surface that faces the light
};

struct FarFieldAgreement {
  int pairs = 0;
  double relative_rms = 0;  // RMS of the differences over RMS of the cloth's values, all colours
  double mean_delta_e = 0, delta_e_95 = 0;
};

struct PbrFit {
  GltfMaterial material;
  bool converged = false;
  int rounds = 0;
};

// Fits a material by least squares in cube roots of radiance, about as the eye weighs brightness, over light from the
// front. Free are roughness, highlight, sheen and strength of the normal map; the diffuse colours follow from the bake
// (pbr_texels.h).
PbrFit fit_material(const BakedSide& side, const std::vector<DirectionPair>& pairs,
                    const std::vector<Eigen::Array3d>& far_field);

// The errors of a material's texels at all pairs.
std::vector<FarFieldError> far_field_errors(const std::vector<PbrTexel>& texels, const GltfShader& shader,
                                            const std::vector<DirectionPair>& pairs,
                                            const std::vector<Eigen::Array3d>& far_field);
// The errors summed up over the pairs with light from the front, or over those with light from behind.
FarFieldAgreement agreement(const std::vector<FarFieldError>& errors, bool front);

nlohmann::json to_json(const GltfMaterial& material);
nlohmann::json to_json(const FarFieldAgreement& agreement);
nlohmann::json to_json(const FarFieldError& error);

}  // namespace station
