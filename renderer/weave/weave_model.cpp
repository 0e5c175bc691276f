#include "renderer/weave/weave_model.h"

#include <algorithm>
#include <cmath>
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
  const double off = anchor.weights.cwiseProduct(points).sum() - anchor.value_mm;
  energy += anchor.stiffness_n_mm / 2 * off * off;
  gradient += anchor.stiffness_n_mm * off * anchor.weights;
  if (curvature != Curvature::none) add_border(0, std::sqrt(anchor.stiffness_n_mm) * anchor.weights);
}

BorderedMatrix WeaveDerivatives::hessian(const Eigen::VectorXi& unknowns) const {
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
  const Eigen::Index count = unknowns.size() ? unknowns.maxCoeff() + 1 : 0;
  const auto borders = static_cast<Eigen::Index>(borders_.size());
  BorderedMatrix result{Eigen::SparseMatrix<double>(count + borders, count + borders), borders};
  Eigen::SparseMatrix<double>& matrix = result.lower;
  matrix.reserve(static_cast<Eigen::Index>(9 * sums.size()) + borders * (count + 1));
  const auto add_borders = [&](int point, int axis, Eigen::Index column) {
    for (std::size_t k = 0; k < borders_.size(); ++k) {
      const Border& border = borders_[k];
      const Eigen::Index at = point - border.first;
      if (at < 0 || at >= border.slope.cols() || border.slope(axis, at) == 0) continue;
      matrix.insertBack(count + static_cast<Eigen::Index>(k), column) = border.slope(axis, at);
    }
  };
  for (std::size_t begin = 0, end = 0; begin < sums.size(); begin = end) {
    while (end < sums.size() && sums[end].column == sums[begin].column) ++end;
    for (int c = 0; c < 3; ++c) {
      const int column = unknowns[3 * sums[begin].column + c];
      if (column < 0) continue;
      matrix.startVec(column);
      for (std::size_t i = begin; i < end; ++i) {
        for (int r = 0; r < 3; ++r) {
          const int row = unknowns[3 * sums[i].row + r];
          if (row >= column) matrix.insertBack(row, column) = sums[i].value(r, c);
        }
      }
      add_borders(sums[begin].column, c, column);
    }
  }
  for (Eigen::Index k = count; k < count + borders; ++k) {
    matrix.startVec(k);
    matrix.insertBack(k, k) = -1;
  }
  matrix.finalize();
  return result;
}

Eigen::VectorXi unknowns_of(const WeaveModel& model) {
  Eigen::VectorXi unknowns = Eigen::VectorXi::Constant(3 * model.points, -1);
  int count = 0;
  for (const ModelYarn& yarn : model.yarns)
    for (int column = yarn.first; column < yarn.first + yarn.count; ++column)
      for (const int axis : {yarn.warp ? 0 : 1, 2}) unknowns[3 * column + axis] = count++;
  return unknowns;
}

}  // namespace renderer
