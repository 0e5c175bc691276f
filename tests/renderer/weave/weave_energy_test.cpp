#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/renderer/weave/shaken_cell.h"

namespace renderer {
namespace {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;

std::vector<ShakenCell> shaken_cells() {
  Draft uneven = twill_draft(2, 1);
  uneven.warp.pitch_mm = 0.8;
  uneven.weft = {.diameter_mm = 0.4, .pitch_mm = 0.95};
  return {ShakenCell(plain_draft(), 0, 1, 1), ShakenCell(uneven, 50, 1, 2), ShakenCell(basket_draft(2), 0, 1.3, 3),
          ShakenCell(plain_draft(), 0, 1.2, 4, 0.1)};
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
