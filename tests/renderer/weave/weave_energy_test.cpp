#include <gtest/gtest.h>

#include <random>

#include "renderer/weave/yarn_contact.h"
#include "renderer/weave/yarn_elasticity.h"

namespace renderer {
namespace {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;

// The yarns of a draft, pressed into each other and shaken, so that no term is at rest and no symmetry helps.
struct ShakenCell {
  WeaveModel model;
  Matrix3Xd points;

  ShakenCell(const Draft& draft, double axial_n, double flatness, unsigned seed) {
    const YarnPatch patch = initial_patch(draft);
    model.period_mm = {patch.period_x_mm, patch.period_y_mm};
    model.contact_n_mm2 = 100;
    std::vector<Eigen::Vector3d> all;
    for (const Yarn& yarn : patch.yarns) {
      ModelYarn m{.warp = yarn.warp,
                  .first = model.points,
                  .count = static_cast<int>(yarn.control_points.size()),
                  .radius_mm = yarn.radius_mm * 1.05,
                  .flatness = flatness,
                  .bending_n_mm2 = 0.05,
                  .tension_n = axial_n > 0 ? 0 : 0.07,
                  .axial_n = axial_n};
      m.length_mm = spline_length(center_line(patch, yarn));
      m.rest_length_mm = 0.97 * m.length_mm;
      model.points += m.count;
      model.yarns.push_back(m);
      all.insert(all.end(), yarn.control_points.begin(), yarn.control_points.end());
    }
    points.resize(3, model.points);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shake(-0.01, 0.01);
    for (int i = 0; i < model.points; ++i)
      points.col(i) = all[static_cast<std::size_t>(i)] + Eigen::Vector3d(shake(random), shake(random), shake(random));
  }

  WeaveDerivatives at(const Matrix3Xd& where, Curvature curvature) const {
    WeaveDerivatives sum(model.points, curvature);
    ContactList contacts;
    contacts.update(model, points);  // one set of samples for all places
    add_elasticity(model, where, sum);
    contacts.add(model, where, sum);
    return sum;
  }
};

std::vector<ShakenCell> shaken_cells() {
  Draft uneven = twill_draft(2, 1);
  uneven.warp.pitch_mm = 0.8;
  uneven.weft = {.diameter_mm = 0.4, .pitch_mm = 0.95};
  return {ShakenCell(plain_draft(), 0, 1, 1), ShakenCell(uneven, 50, 1, 2), ShakenCell(basket_draft(2), 0, 1.3, 3)};
}

TEST(WeaveEnergyTest, TheGradientIsThatOfFiniteDifferences) {
  for (const ShakenCell& cell : shaken_cells()) {
    const WeaveDerivatives here = cell.at(cell.points, Curvature::none);
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    double worst = 0;
    for (int trial = 0; trial < 20; ++trial) {
      const Matrix3Xd direction = Matrix3Xd::NullaryExpr(3, cell.model.points, [&] { return normal(random); });
      const double h = 1e-6;
      const double difference = (cell.at(cell.points + h * direction, Curvature::none).energy -
                                 cell.at(cell.points - h * direction, Curvature::none).energy) /
                                (2 * h);
      const double slope = here.gradient.cwiseProduct(direction).sum();
      worst = std::max(worst, std::abs(difference - slope) / here.gradient.norm());
    }
    std::cout << "gradient against central differences: " << worst << " of its norm\n";
    // h^2 / 6 of the third derivatives, which contact with stiffness 30 N/mm^2 and f''' at the edge make large
    EXPECT_LT(worst, 2e-6);
  }
}

TEST(WeaveEnergyTest, TheSecondDerivativesAreThoseOfFiniteDifferencesOfTheGradient) {
  for (const ShakenCell& cell : shaken_cells()) {
    WeaveDerivatives here = cell.at(cell.points, Curvature::exact);
    const Eigen::Index count = 3 * cell.model.points;
    const BorderedMatrix matrix = here.hessian(Eigen::VectorXi::LinSpaced(count, 0, static_cast<int>(count) - 1));
    const Eigen::MatrixXd bordered = Eigen::MatrixXd(matrix.lower).selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd borders = bordered.bottomLeftCorner(matrix.borders, count),
                          full = bordered.topLeftCorner(count, count) + borders.transpose() * borders;
    std::mt19937 random(8);
    std::normal_distribution<double> normal;
    double worst = 0;
    for (int trial = 0; trial < 10; ++trial) {
      const Matrix3Xd direction = Matrix3Xd::NullaryExpr(3, cell.model.points, [&] { return normal(random); });
      const double h = 3e-9;
      const Matrix3Xd difference = (cell.at(cell.points + h * direction, Curvature::none).gradient -
                                    cell.at(cell.points - h * direction, Curvature::none).gradient) /
                                   (2 * h);
      const VectorXd product = full * direction.reshaped();
      worst = std::max(worst, (difference.reshaped() - product).norm() / product.norm());
    }
    std::cout << "second derivatives against differences of the gradient: " << worst << "\n";
    EXPECT_LT(worst, 1e-4);  // samples that come into contact within h change the stiffness at once
  }
}

}  // namespace
}  // namespace renderer
