#include "renderer/weave/yarn_elasticity.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace renderer {
namespace {

// Energy per knot as a function of A = y'.y', C = y''.y'', D = y'.y''; its derivatives carry those letters.
struct Density {
  double value = 0, a = 0, c = 0, d = 0, aa = 0, ac = 0, ad = 0, dd = 0;
};

// The energy density of bending and of a pull along the yarn.
Density density(double bending_n_mm2, double pull_n, double A, double C, double D) {
  const double speed = std::sqrt(A);
  Density e;
  const double N = A * C - D * D, half_bending = bending_n_mm2 / 2;
  const double A5 = 1 / (A * A * speed), A7 = A5 / A, A9 = A7 / A;  // A^(-5/2) and on
  e.value = half_bending * N * A5 + pull_n * speed;
  e.c = half_bending * A * A5;
  e.d = -2 * half_bending * D * A5;
  e.a = half_bending * (C * A5 - 2.5 * N * A7) + pull_n / (2 * speed);
  e.aa = half_bending * (-5 * C * A7 + 8.75 * N * A9) - pull_n / (4 * A * speed);
  e.ac = -1.5 * half_bending * A5;
  e.ad = 5 * half_bending * D * A7;
  e.dd = -2 * half_bending * A5;
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

const std::array<GaussPoint, 3>& gauss() {
  static const std::array<GaussPoint, 3> kGauss = gauss_points();
  return kGauss;
}

struct Segment {
  std::array<PointRef, 4> refs;
  Eigen::Matrix<double, 3, 4> controls;

  Segment(const WeaveModel& model, const ModelYarn& yarn, int k, const Eigen::Matrix3Xd& points) {
    for (int i = 0; i < 4; ++i) {
      refs[static_cast<std::size_t>(i)] = point_ref(yarn, k - 1 + i);
      controls.col(i) = position(model, points, refs[static_cast<std::size_t>(i)]);
    }
  }
};

// The spring's energy and the border of its second derivatives; returns its pull.
double add_spring(const WeaveModel& model, const ModelYarn& yarn, const Eigen::Matrix3Xd& points,
                  WeaveDerivatives& sum) {
  double length = 0;
  Eigen::Matrix3Xd slope = Eigen::Matrix3Xd::Zero(3, yarn.count);  // of the length
  for (int k = 0; k < yarn.count; ++k) {
    const Segment segment(model, yarn, k, points);
    for (const GaussPoint& point : gauss()) {
      const Eigen::Vector3d a = segment.controls * point.first;
      length += point.weight * a.norm();
      for (int i = 0; i < 4; ++i)
        slope.col(segment.refs[static_cast<std::size_t>(i)].column - yarn.first) +=
            point.weight * point.first[i] * a.normalized();
    }
  }
  const double strain = length / yarn.rest_length_mm - 1;
  sum.energy += yarn.axial_n * (strain * strain * yarn.rest_length_mm / 2 - strain * length);  // the pull adds the last
  if (sum.curvature != Curvature::none)
    sum.add_border(yarn.first, std::sqrt(yarn.axial_n / yarn.rest_length_mm) * slope);
  return yarn.axial_n * strain;
}

}  // namespace

void add_elasticity(const WeaveModel& model, const Eigen::Matrix3Xd& points, WeaveDerivatives& sum) {
  for (const ModelYarn& yarn : model.yarns) {
    const double pull = yarn.tension_n + (yarn.axial_n > 0 ? add_spring(model, yarn, points, sum) : 0);
    for (int k = 0; k < yarn.count; ++k) {
      const Segment segment(model, yarn, k, points);
      Eigen::Matrix<double, 3, 4> gradient = Eigen::Matrix<double, 3, 4>::Zero();
      Eigen::Matrix<double, 12, 12> hessian = Eigen::Matrix<double, 12, 12>::Zero();
      for (const GaussPoint& point : gauss()) {
        const Eigen::Vector3d a = segment.controls * point.first, b = segment.controls * point.second;
        const Density e = density(yarn.bending_n_mm2, pull, a.squaredNorm(), b.squaredNorm(), a.dot(b));
        sum.energy += point.weight * e.value;
        gradient += point.weight * ((2 * e.a * a + e.d * b) * point.first.transpose() +
                                    (2 * e.c * b + e.d * a) * point.second.transpose());
        if (sum.curvature == Curvature::none) continue;
        Matrix6d h = second_derivatives(e, a, b);
        if (sum.curvature == Curvature::positive) h = positive_part(h);
        h *= point.weight;
        for (int p = 0; p < 4; ++p) {
          for (int q = 0; q < 4; ++q) {
            hessian.block<3, 3>(3 * p, 3 * q) += point.first[p] * point.first[q] * h.topLeftCorner<3, 3>() +
                                                 point.first[p] * point.second[q] * h.topRightCorner<3, 3>() +
                                                 point.second[p] * point.first[q] * h.bottomLeftCorner<3, 3>() +
                                                 point.second[p] * point.second[q] * h.bottomRightCorner<3, 3>();
          }
        }
      }
      sum.add<4>(segment.refs, gradient);
      if (sum.curvature != Curvature::none) sum.add_curvature<4>(segment.refs, hessian);
    }
  }
}

}  // namespace renderer
