// How much wider the world is than the patch of a cloth.
#pragma once

#include <Eigen/Core>

namespace renderer {

// The factors along the patch's x and y: middle + growth z at height z. Yarns do not widen with it (yarn_grid.h).
struct Spread {
  Eigen::Vector2f middle = Eigen::Vector2f::Ones(), growth = Eigen::Vector2f::Zero();  // growth: 1 / mm
  bool is_none() const { return middle == Eigen::Vector2f::Ones() && growth == Eigen::Vector2f::Zero(); }
};

}  // namespace renderer
