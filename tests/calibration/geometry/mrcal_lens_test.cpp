#include "calibration/geometry/mrcal_lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/calibration/geometry/synthetic_views.h"

namespace calibration {
namespace {

const Lattice kBoard{.columns = 12, .rows = 9, .spacing_mm = 10.0};
const Eigen::Vector2d kBow_mm(0.3, -0.1);

ModelledLens modelled(const Lens& lens) {
  const auto& k = lens.distortion;
  return {LensModel::opencv5,
          {lens.width_px, lens.height_px},
          {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, k[0], k[1], k[2], k[3], k[4]}};
}

// Noisy views of a bent board, with the true lens and poses as the seed and a flat board.
LensBundle bundle(double sigma_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  LensBundle out{.lattice = kBoard, .lens = as(LensModel::opencv4, modelled(synthetic::narrow_lens()))};
  const Eigen::Translation3d centre(-kBoard.point(kBoard.columns - 1, kBoard.rows - 1) / 2);
  for (const Eigen::Isometry3d& pose : synthetic::handheld_poses(15, random)) {
    BundlePicture view{.camera_from_lattice = pose * centre};
    view.corners = synthetic::observe_lattice(synthetic::narrow_lens(), kBoard, kBow_mm, view.camera_from_lattice);
    for (LatticeCorner& corner : view.corners) {
      const double dx = noise(random), dy = noise(random);
      corner.pixel += sigma_px * Eigen::Vector2d(dx, dy);
    }
    view.used.assign(view.corners.size(), true);
    if (view.corners.size() >= 8) out.pictures.push_back(view);
  }
  return out;
}

constexpr BundleFreedom kFree{.regularised = false, .reject_outliers = false};

TEST(MrcalLens, ExactViewsOfABentBoardGiveLensAndBowToSixDigits) {
  LensBundle exact = bundle(0.0, 1);
  exact.lens.intrinsics[0] *= 1.02;
  exact.lens.intrinsics[4] = 0.0;
  EXPECT_TRUE(solve_bundle(exact, kFree).finite);
  const Lens truth = synthetic::narrow_lens();
  EXPECT_NEAR(exact.lens.intrinsics[0], truth.fx_px, 1e-2);
  EXPECT_NEAR(exact.lens.intrinsics[3], truth.cy_px, 1e-2);
  EXPECT_NEAR(exact.warp_mm.x(), kBow_mm.x(), 1e-5);  // up to what the optimiser takes for converged
  EXPECT_NEAR(exact.warp_mm.y(), kBow_mm.y(), 1e-5);
}

TEST(MrcalLens, ItsErrorsAreOurProjectionMinusWhatWasSeen) {
  LensBundle noisy = bundle(0.2, 2);
  solve_bundle(noisy, kFree);
  const BundleUncertainty uncertainty = linearise(noisy, kFree);
  Lens lens = synthetic::narrow_lens();
  const std::vector<double>& p = noisy.lens.intrinsics;
  lens.fx_px = p[0];
  lens.fy_px = p[1];
  lens.cx_px = p[2];
  lens.cy_px = p[3];
  lens.distortion = {p[4], p[5], p[6], p[7], 0.0};
  double squares = 0.0, count = 0.0;
  for (std::size_t v = 0; v < noisy.pictures.size(); ++v) {
    const BundlePicture& view = noisy.pictures[v];
    const BoardPicture predicted = synthetic::observe_lattice(lens, kBoard, noisy.warp_mm, view.camera_from_lattice);
    for (const LatticeCorner& there : predicted)
      for (std::size_t c = 0; c < view.corners.size(); ++c) {
        const LatticeCorner& seen = view.corners[c];
        if (seen.column != there.column || seen.row != there.row) continue;
        EXPECT_LT((there.pixel - seen.pixel - uncertainty.errors_px[v][c]).norm(), 1e-6);
        squares += uncertainty.errors_px[v][c].squaredNorm();
        count += 2.0;
      }
  }
  EXPECT_NEAR(uncertainty.rms_px, std::sqrt(squares / count), 1e-3);
  EXPECT_NEAR(uncertainty.sigma_px, 0.2, 0.2 * 3.0 / std::sqrt(count));  // three standard errors
  EXPECT_LT(uncertainty.step_px, 1e-3);
}

TEST(MrcalLens, AWildCornerIsTakenOutAndNothingIsPrinted) {
  LensBundle clean = bundle(0.1, 3), wild = clean;
  const BundleFreedom rejecting{.regularised = false, .reject_outliers = true};
  solve_bundle(clean, rejecting);
  wild.pictures[4].corners[7].pixel.x() += 500.0;
  testing::internal::CaptureStderr();
  const BundleOutcome outcome = solve_bundle(wild, rejecting);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_NE(outcome.messages.find("outliers"), std::string::npos) << outcome.messages;
  EXPECT_FALSE(wild.pictures[4].used[7]);
  EXPECT_NEAR(wild.lens.intrinsics[0], clean.lens.intrinsics[0], 0.3);  // a tenth of its standard error
}

TEST(MrcalLens, UncertaintyAtTheWorkingDistanceIsSmallerThanFarAway) {
  LensBundle noisy = bundle(0.1, 4);
  solve_bundle(noisy, kFree);
  const BundleUncertainty uncertainty = linearise(noisy, kFree);
  const auto sigma_px = [&](double distance_mm) {
    return std::sqrt(projection_covariance(noisy, uncertainty, {300, 200}, distance_mm).trace());
  };
  EXPECT_LT(sigma_px(600), 0.5 * sigma_px(1e6));
  EXPECT_LT(sigma_px(600), 0.1);
}

TEST(MrcalLens, CornersThatAreNotNumbersOrBesideTheBoardAreRefused) {
  LensBundle broken = bundle(0.1, 5);
  broken.pictures[2].corners[3].pixel.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solve_bundle(broken, kFree), std::runtime_error);
  broken = bundle(0.1, 5);
  broken.pictures[2].corners[3].column = 12;
  EXPECT_THROW(linearise(broken, kFree), std::runtime_error);
  LensBundle empty;
  EXPECT_THROW(solve_bundle(empty, kFree), std::runtime_error);
}

TEST(MrcalLens, ACameramodelNamesModelAndNumbers) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "threadstation_lens.cameramodel";
  write_cameramodel(modelled(synthetic::narrow_lens()), file);
  std::ifstream stream(file);
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  std::filesystem::remove(file);
  EXPECT_NE(text.find("LENSMODEL_OPENCV5"), std::string::npos) << text;
  EXPECT_NE(text.find("2402.000000"), std::string::npos) << text;
  EXPECT_NE(text.find("600"), std::string::npos) << text;
  EXPECT_THROW(write_cameramodel(modelled(synthetic::narrow_lens()), "/nowhere/x.cameramodel"), std::runtime_error);
}

}  // namespace
}  // namespace calibration
