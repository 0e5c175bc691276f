// Which yarn of a cloth each segment of its curves (cell_curves_of) belongs to.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "renderer/weave/patch.h"

namespace renderer {

// A yarn among all of a scene.
struct YarnPlace {
  std::uint32_t group = 0;  // the scene's curve sets, then its cloths
  bool weft = false;
  int number =
      0;  // of a cloth: across its warp or weft, 0 the first of the patch at its origin; of a curve set: its curve
};

class YarnPlaces {
 public:
  // For the curves of round_yarns_of x threads_of (patch_curves.h), each within the margin.
  YarnPlaces(const YarnPatch& patch, double margin_mm);

  // Of a segment of the curves numbered `yarns`, when the cell lies at `tile` in the endless patch; group 0.
  YarnPlace at(std::size_t yarns, std::size_t segment, const Eigen::Vector3d& tile) const;

 private:
  int ends_ = 0, picks_ = 0;  // warp and weft yarns of a period
  Eigen::Vector2d period_mm_;
  std::vector<std::vector<YarnPlace>> places_;  // in the cell at 0
};

}  // namespace renderer
