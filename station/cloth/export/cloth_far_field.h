// The far field of a cloth: the mean radiance of a whole period for single directions of view and light.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "station/cloth/export/cloth_sample.h"

namespace station {

struct DirectionPair {
  Eigen::Vector3d to_view, to_light;  // unit, in the cloth's frame; views above the cloth, lights above or below
};

struct FarFieldOptions {
  int samples_per_pair = 16384;
  std::uint64_t seed = 1;
  PartProgress progress = [](double) { return true; };
};

// The far field for each pair, linear sRGB: pi x mean radiance over the cloth as it is seen, over irradiance
// perpendicular to the light; a white matt surface would have the cosine of the light. Errors: those of render_or_stop
// and surface_of.
std::vector<Eigen::Array3d> far_field(const ClothSample& cloth, const std::vector<DirectionPair>& pairs,
                                      const FarFieldOptions& options);

// The unit direction at an angle from the cloth's normal and an azimuth from the weft.
Eigen::Vector3d direction_at(double polar_deg, double azimuth_deg);

// The pairs that exports are fitted to: views from straight above to 70 degrees along both systems of yarns, with
// lights in front of the cloth and behind it.
std::vector<DirectionPair> standard_pairs();

}  // namespace station
