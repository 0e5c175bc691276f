// The table of which yarn each segment of a cloth's curves (cell_curves_of) belongs to.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "renderer/scene/patch_curves.h"
#include "renderer/weave/patch.h"

namespace renderer {

// A yarn of a scene. Yarns of a cloth are numbered across its warp or weft, from 0 for the first of the patch at the
// origin; yarns of a curve set are numbered as its curves.
struct YarnPlace {
  std::uint32_t group = 0;  // number among the scene's curve sets and, after them, its cloths
  bool weft = false;
  int number = 0;
};

class YarnPlaces {
 public:
  // For the curves that cell_curves_of() makes, with this margin, of each part of round_yarns_of() and each thread of
  // threads_of() (patch_curves.h).
  YarnPlaces(const YarnPatch& patch, double margin_mm);

  // Adds curves whose segments come out of these yarns of the patch.
  void add(const std::vector<SegmentOrigin>& origins);

  // The yarn of a segment of curves number `yarns`, when the cell lies at `tile` (mm) in the endless patch; its group
  // is 0.
  YarnPlace at(std::size_t yarns, std::size_t segment, const Eigen::Vector3d& tile) const;

 private:
  YarnPlace place_of(int number, int image) const;

  int ends_ = 0, picks_ = 0;  // warp and weft yarns of a period
  Eigen::Vector2d period_mm_;
  std::vector<std::vector<YarnPlace>> places_;  // of each segment, by curves, when the cell lies at 0
};

}  // namespace renderer
