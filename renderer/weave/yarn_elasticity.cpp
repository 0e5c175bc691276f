#include "renderer/weave/yarn_elasticity.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace renderer {
namespace {

// Energy per knot as a function of A = y'.y', C = y''.y'', D = y'.y''; its derivatives carry those letters.
struct Density {
  double value = 0, a = 0, c = 0, d = 0, aa = 0, ac = 0, ad = 0, dd = 0;
};

Density density(const ModelYarn& yarn, double A, double C, double D) {
  const double speed = std::sqrt(A), per_knot = 1.0 / yarn.count;
  Density e;
  const double N = A * C - D * D, half_bending = yarn.bending_n_mm2 / 2;
  const double A5 = 1 / (A * A * speed), A7 = A5 / A, A9 = A7 / A;  // A^(-5/2) and on
  e.value = half_bending * N * A5;
  e.c = half_bending * A * A5;
  e.d = -2 * half_bending * D * A5;
  e.a = half_bending * (C * A5 - 2.5 * N * A7);
  e.aa = half_bending * (-5 * C * A7 + 8.75 * N * A9);
  e.ac = -1.5 * half_bending * A5;
  e.ad = 5 * half_bending * D * A7;
  e.dd = -2 * half_bending * A5;

  const double rest = yarn.rest_length_mm * per_knot;
  double pull = yarn.tension_n, stiffness = 0;  // force along the yarn and its derivative to the speed
  e.value += yarn.tension_n * speed;
  if (yarn.axial_n > 0) {
    const double strain = speed / rest - 1;
    e.value += yarn.axial_n / 2 * strain * strain * rest;
    pull += yarn.axial_n * strain;
    stiffness = yarn.axial_n / rest;
  }
  e.a += pull / (2 * speed);
  e.aa += stiffness / (4 * A) - pull / (4 * A * speed);

  const double spread = yarn.spread_n / (yarn.length_mm * per_knot);
  e.value += spread / 2 * D * D / A;
  e.d += spread * D / A;
  e.a -= spread / 2 * D * D / (A * A);
  e.dd += spread / A;
  e.ad -= spread * D / (A * A);
  e.aa += spread * D * D / (A * A * A);
  return e;
}

using Matrix6d = Eigen::Matrix<double, 6, 6>;

Matrix6d second_derivatives(const Density& e, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  Matrix6d h;
  h.topLeftCorner<3, 3>() =
      2 * e.a * unit + 2 * a * (2 * e.aa * a + e.ad * b).transpose() + b * (2 * e.ad * a + e.dd * b).transpose();
  h.topRightCorner<3, 3>() = e.d * unit + 2 * a * (2 * e.ac * b + e.ad * a).transpose() + e.dd * b * a.transpose();
  h.bottomLeftCorner<3, 3>() = h.topRightCorner<3, 3>().transpose();
  h.bottomRightCorner<3, 3>() = 2 * e.c * unit + e.dd * a * a.transpose();
  return h;
}

Matrix6d positive_part(const Matrix6d& h) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(h);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

struct GaussPoint {
  Eigen::Vector4d first, second;  // weights of the control points in y' and y''
  double weight;
};

std::array<GaussPoint, 3> gauss_points() {
  const double offset = std::sqrt(0.15);
  const auto at = [](double u, double weight) {
    return GaussPoint{spline_weights(u, 1), spline_weights(u, 2), weight};
  };
  return {at(0.5 - offset, 5.0 / 18), at(0.5, 8.0 / 18), at(0.5 + offset, 5.0 / 18)};
}

}  // namespace

void add_elasticity(const WeaveModel& model, const Eigen::Matrix3Xd& points, WeaveDerivatives& sum) {
  static const std::array<GaussPoint, 3> kGauss = gauss_points();
  for (const ModelYarn& yarn : model.yarns) {
    for (int k = 0; k < yarn.count; ++k) {
      std::array<PointRef, 4> refs;
      Eigen::Matrix<double, 3, 4> controls;
      for (int i = 0; i < 4; ++i) {
        refs[static_cast<std::size_t>(i)] = point_ref(yarn, k - 1 + i);
        controls.col(i) = position(model, points, refs[static_cast<std::size_t>(i)]);
      }
      Eigen::Matrix<double, 3, 4> gradient = Eigen::Matrix<double, 3, 4>::Zero();
      Eigen::Matrix<double, 12, 12> hessian = Eigen::Matrix<double, 12, 12>::Zero();
      for (const GaussPoint& gauss : kGauss) {
        const Eigen::Vector3d a = controls * gauss.first, b = controls * gauss.second;
        const Density e = density(yarn, a.squaredNorm(), b.squaredNorm(), a.dot(b));
        sum.energy += gauss.weight * e.value;
        gradient += gauss.weight * ((2 * e.a * a + e.d * b) * gauss.first.transpose() +
                                    (2 * e.c * b + e.d * a) * gauss.second.transpose());
        if (sum.curvature == Curvature::none) continue;
        Matrix6d h = second_derivatives(e, a, b);
        if (sum.curvature == Curvature::positive) h = positive_part(h);
        h *= gauss.weight;
        for (int p = 0; p < 4; ++p) {
          for (int q = 0; q < 4; ++q) {
            hessian.block<3, 3>(3 * p, 3 * q) += gauss.first[p] * gauss.first[q] * h.topLeftCorner<3, 3>() +
                                                 gauss.first[p] * gauss.second[q] * h.topRightCorner<3, 3>() +
                                                 gauss.second[p] * gauss.first[q] * h.bottomLeftCorner<3, 3>() +
                                                 gauss.second[p] * gauss.second[q] * h.bottomRightCorner<3, 3>();
          }
        }
      }
      sum.add<4>(refs, gradient);
      if (sum.curvature != Curvature::none) sum.add_curvature<4>(refs, hessian);
    }
  }
}

}  // namespace renderer
