// Weave model: what stays the same while the yarns of a patch move, and where the derivatives of their energy are added.
//
// The unknowns are the control points of all yarns (periodic_spline.h), side by side as the columns of one 3 x n
// matrix, mm. Control point k of a yarn, any k, is a column moved by whole periods of the cell: a PointRef. Forces in
// newtons, energies in N mm.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "renderer/weave/patch.h"

namespace renderer {

struct ModelYarn {
  bool warp = true;
  int first = 0, count = 0;  // columns of its control points
  double radius_mm = 0.25;
  double flatness = 1.0;
  double bending_n_mm2 = 0.05;
  double tension_n = 0.0;       // dead load: energy tension x length
  double axial_n = 0.0;         // spring: energy axial / 2 x (length / rest length - 1)^2 x rest length
  double rest_length_mm = 0.0;  // of one period; for the spring
  double spread_n = 0.0;        // keeps the control points evenly spaced; no force when they are
  double length_mm = 0.0;       // of one period at the start, for the weights of contact samples
};

// A spring that holds one coordinate of one control point where it was.
struct Anchor {
  int column = 0, axis = 0;
  double value_mm = 0, stiffness_n_mm = 0;
};

struct WeaveModel {
  std::vector<ModelYarn> yarns;
  std::vector<Anchor> anchors;
  Eigen::Vector2d period_mm = Eigen::Vector2d::Ones();
  double contact_n_mm2 = 0.0;  // force per length of contact and depth of overlap
  int points = 0;
};

struct PointRef {
  int column = 0;
  Eigen::Vector2i cell = Eigen::Vector2i::Zero();  // periods in x and y by which it is moved
};

// Control point k (any k) of a yarn that is itself moved by `cell` periods.
PointRef point_ref(const ModelYarn& yarn, int k, const Eigen::Vector2i& cell = Eigen::Vector2i::Zero());
Eigen::Vector3d position(const WeaveModel& model, const Eigen::Matrix3Xd& points, const PointRef& ref);

// Which second derivatives are wanted: none; those of the energy; or a positive semidefinite part of them, which leads
// downhill from anywhere.
enum class Curvature { none, exact, positive };

// Sum of energies and of their derivatives.
class WeaveDerivatives {
 public:
  WeaveDerivatives(int points, Curvature curvature);

  void add(const Anchor& anchor, const Eigen::Matrix3Xd& points);
  // Adds the contribution of one element of N control points.
  template <int N>
  void add(const std::array<PointRef, N>& refs, const Eigen::Matrix<double, 3, N>& slope) {
    for (int p = 0; p < N; ++p) add_gradient(refs[static_cast<std::size_t>(p)], slope.col(p));
  }
  template <int N>
  void add_curvature(const std::array<PointRef, N>& refs, const Eigen::Matrix<double, 3 * N, 3 * N>& second) {
    for (int p = 0; p < N; ++p) {
      const int row = refs[static_cast<std::size_t>(p)].column;
      for (int q = 0; q < N; ++q) {
        const int column = refs[static_cast<std::size_t>(q)].column;
        if (row >= column) blocks_.push_back({row, column, second.template block<3, 3>(3 * p, 3 * q)});
      }
    }
  }

  // Second derivatives between the control points of two elements that share none; rows belong to `a`.
  template <int N>
  void add_cross_curvature(const std::array<PointRef, N>& a, const std::array<PointRef, N>& b,
                           const Eigen::Matrix<double, 3 * N, 3 * N>& second) {
    for (int p = 0; p < N; ++p) {
      const int row = a[static_cast<std::size_t>(p)].column;
      for (int q = 0; q < N; ++q) {
        const int column = b[static_cast<std::size_t>(q)].column;
        const Eigen::Matrix3d block = second.template block<3, 3>(3 * p, 3 * q);
        if (row > column)
          blocks_.push_back({row, column, block});
        else
          blocks_.push_back({column, row, block.transpose()});
      }
    }
  }

  double energy = 0.0;
  Eigen::Matrix3Xd gradient;
  Eigen::Vector2d period_gradient = Eigen::Vector2d::Zero();  // to the periods of the cell, control points held
  Curvature curvature;

  // Lower triangle of the 3 n x 3 n matrix, 3 x 3 blocks summed. Ordered, so the same everywhere.
  Eigen::SparseMatrix<double> hessian();

 private:
  struct Block {
    int row, column;
    Eigen::Matrix3d value;
  };
  void add_gradient(const PointRef& ref, const Eigen::Vector3d& value) {
    gradient.col(ref.column) += value;
    period_gradient += ref.cell.cast<double>().cwiseProduct(value.head<2>());
  }
  std::vector<Block> blocks_;
};

}  // namespace renderer
