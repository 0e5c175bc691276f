// Matrices as documents have them: nine numbers, row after row.
#pragma once

#include <Eigen/Core>
#include <array>

namespace station {

inline Eigen::Matrix3d matrix_of(const std::array<double, 9>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

}  // namespace station
