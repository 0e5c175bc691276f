#include "renderer/scattering/circle_grid.h"

#include <algorithm>

namespace renderer {
namespace {

constexpr double kCellRadii = 2;  // side of a cell; 1.5 to 3 are equally fast, beyond that it gets slower
constexpr int kMostCells = 2048;  // a side

}  // namespace

CircleGrid::CircleGrid(const std::vector<Eigen::Vector2d>& centers, double radius, double reach)
    : centers_(centers), radius2_(radius * radius), reach_(reach) {
  side_ = std::clamp(static_cast<int>(2 * reach / (kCellRadii * radius)), 1, kMostCells);
  cell_ = 2 * reach / side_;
  inverse_cell_ = 1 / cell_;
  const auto cell_of = [&](double coordinate) {
    return std::clamp(static_cast<int>((coordinate + reach_) * inverse_cell_), 0, side_ - 1);
  };
  // A cell keeps the circles that reach into it; each is looked at twice, to count and then to fill.
  const auto for_each_entry = [&](const auto& use) {
    for (std::size_t i = 0; i < centers_.size(); ++i) {
      const Eigen::Vector2d& c = centers_[i];
      for (int y = cell_of(c.y() - radius); y <= cell_of(c.y() + radius); ++y)
        for (int x = cell_of(c.x() - radius); x <= cell_of(c.x() + radius); ++x) {
          const Eigen::Vector2d low(x * cell_ - reach_, y * cell_ - reach_);
          const Eigen::Vector2d nearest =
              c.cwiseMax(low).cwiseMin(low.array().matrix() + Eigen::Vector2d(cell_, cell_));
          if ((nearest - c).squaredNorm() <= radius2_)
            use(static_cast<std::size_t>((y + 1) * (side_ + 2) + x + 1), Entry{c, static_cast<int>(i)});
        }
    }
  };
  first_.assign(static_cast<std::size_t>((side_ + 2) * (side_ + 2)) + 1, 0);
  for_each_entry([&](std::size_t cell, const Entry&) { ++first_[cell + 1]; });
  for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  entries_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_each_entry([&](std::size_t cell, const Entry& entry) { entries_[next[cell]++] = entry; });
}

}  // namespace renderer
