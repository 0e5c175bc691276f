// The weave model: what stays the same while the yarns of a patch move, and where the derivatives of their energy are
// added.
//
// The control points of all yarns (periodic_spline.h) stand side by side as the columns of one 3 x n matrix, mm.
// Control point k of a yarn, any k, is a column moved by whole periods of the cell: a PointRef. Forces in newtons,
// energies in N mm.
//
// The unknowns are two coordinates of each control point, sideways and up; the third, along the yarn, stays where it is
// drawn. The energies do not depend on where along a yarn its points lie, so that without friction nothing holds that
// third coordinate. When it was an unknown too, yarns slid along themselves into the small dents that points and
// samples leave in their energy, each yarn into its own; Newton's method took three times the steps, and repeats of a
// patch came to rest differently.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <utility>
#include <vector>

#include "renderer/weave/patch.h"

namespace renderer {

struct ModelYarn {
  bool warp = true;
  int first = 0, count = 0;  // columns of its control points
  double radius_mm = 0.25;
  double flatness = 1.0;
  double bending_n_mm2 = 0.05;
  double tension_n = 0.0;           // dead load: energy tension x length
  double axial_n = 0.0;             // spring: energy axial / 2 x (length / rest length - 1)^2 x rest length
  double rest_length_mm = 0.0;      // of one period; for the spring
  double length_mm = 0.0;           // of one period at the start, for the weights of contact samples
  std::vector<double> thickness{};  // profile (patch.h) of the radius, used by contact
};

// A spring that holds the mean of one coordinate of some control points where it was.
struct Anchor {
  Eigen::Matrix3Xd weights;  // the mean is the sum of weights x points
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
  Eigen::Vector2i cell = Eigen::Vector2i::Zero();  // periods in x and y by which the point is moved
};

// Control point k (any k) of a yarn that is itself moved by `cell` periods, and its position, mm.
PointRef point_ref(const ModelYarn& yarn, int k, const Eigen::Vector2i& cell = Eigen::Vector2i::Zero());
Eigen::Vector3d position(const WeaveModel& model, const Eigen::Matrix3Xd& points, const PointRef& ref);

// Which second derivatives are wanted: none; those of the energy; or a positive semidefinite part of them, with which
// Newton's step leads downhill from anywhere.
enum class Curvature { none, exact, positive };

// Second derivatives that contain products v v^T of long vectors, which would couple many unknowns. Instead of that
// dense part the matrix has a row for each v, with -1 on the diagonal. Eliminating those rows gives the second
// derivatives; they are positive definite exactly where the matrix has as many negative eigenvalues as it has such
// rows.
struct BorderedMatrix {
  Eigen::SparseMatrix<double> lower;  // lower triangle
  Eigen::Index borders = 0;           // the number of such rows, the last ones
};

// The sum of energies and of their derivatives, to which each part of the model adds its own.
class WeaveDerivatives {
 public:
  WeaveDerivatives(int points, Curvature curvature);

  void add(const Anchor& anchor, const Eigen::Matrix3Xd& points);
  // Add the slope and the second derivatives of one element of N control points.
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

  // Adds the second derivatives between the control points of two elements that share none; rows belong to `a`.
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
  Eigen::Vector2d period_gradient = Eigen::Vector2d::Zero();  // by the periods of the cell, control points held
  Curvature curvature;

  // Adds slope slope^T to the second derivatives, where slope is given for the control points from `first` on.
  void add_border(int first, Eigen::Matrix3Xd slope) { borders_.push_back({first, std::move(slope)}); }

  // The second derivatives by those of the 3 n coordinates that are unknowns: unknowns[coordinate] is the unknown's
  // number from 0, or -1.
  BorderedMatrix hessian(const Eigen::VectorXi& unknowns) const;

 private:
  struct Border {
    int first;
    Eigen::Matrix3Xd slope;
  };
  struct Block {
    int row, column;
    Eigen::Matrix3d value;
  };
  void add_gradient(const PointRef& ref, const Eigen::Vector3d& value) {
    gradient.col(ref.column) += value;
    period_gradient += ref.cell.cast<double>().cwiseProduct(value.head<2>());
  }
  std::vector<Block> blocks_;
  std::vector<Border> borders_;
};

// The numbers of a model's unknowns, as WeaveDerivatives::hessian() wants them.
Eigen::VectorXi unknowns_of(const WeaveModel& model);

}  // namespace renderer
