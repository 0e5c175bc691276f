#include "renderer/weave/weave_model.h"

#include <algorithm>
#include <numeric>

namespace renderer {

PointRef point_ref(const ModelYarn& yarn, int k, const Eigen::Vector2i& cell) {
  const int turn = k >= 0 ? k / yarn.count : -((yarn.count - 1 - k) / yarn.count);
  PointRef ref{.column = yarn.first + k - turn * yarn.count, .cell = cell};
  ref.cell[yarn.warp ? 1 : 0] += turn;
  return ref;
}

Eigen::Vector3d position(const WeaveModel& model, const Eigen::Matrix3Xd& points, const PointRef& ref) {
  Eigen::Vector3d p = points.col(ref.column);
  p.head<2>() += model.period_mm.cwiseProduct(ref.cell.cast<double>());
  return p;
}

WeaveDerivatives::WeaveDerivatives(int points, Curvature wanted)
    : gradient(Eigen::Matrix3Xd::Zero(3, points)), curvature(wanted) {}

void WeaveDerivatives::add(const Anchor& anchor, const Eigen::Matrix3Xd& points) {
  const double off = points(anchor.axis, anchor.column) - anchor.value_mm;
  energy += anchor.stiffness_n_mm / 2 * off * off;
  gradient(anchor.axis, anchor.column) += anchor.stiffness_n_mm * off;
  if (curvature == Curvature::none) return;
  Block block{anchor.column, anchor.column, Eigen::Matrix3d::Zero()};
  block.value(anchor.axis, anchor.axis) = anchor.stiffness_n_mm;
  blocks_.push_back(block);
}

Eigen::SparseMatrix<double> WeaveDerivatives::hessian() {
  std::vector<std::size_t> order(blocks_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(blocks_[a].column, blocks_[a].row) < std::pair(blocks_[b].column, blocks_[b].row);
  });
  std::vector<Block> sums;
  for (const std::size_t index : order) {
    const Block& block = blocks_[index];
    if (!sums.empty() && sums.back().row == block.row && sums.back().column == block.column)
      sums.back().value += block.value;
    else
      sums.push_back(block);
  }
  const auto size = 3 * gradient.cols();
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.reserve(static_cast<Eigen::Index>(9 * sums.size()));
  for (std::size_t begin = 0, end = 0; begin < sums.size(); begin = end) {
    while (end < sums.size() && sums[end].column == sums[begin].column) ++end;
    for (int c = 0; c < 3; ++c) {
      const int column = 3 * sums[begin].column + c;
      matrix.startVec(column);
      for (std::size_t i = begin; i < end; ++i) {
        for (int r = 0; r < 3; ++r) {
          const int row = 3 * sums[i].row + r;
          if (row >= column) matrix.insertBack(row, column) = sums[i].value(r, c);
        }
      }
    }
  }
  matrix.finalize();
  return matrix;
}

}  // namespace renderer
