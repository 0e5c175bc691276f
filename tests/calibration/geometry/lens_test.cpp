#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <opencv2/calib3d.hpp>

#include "calibration/geometry/lens_fit.h"
#include "calibration/geometry/pose.h"
#include "tests/calibration/geometry/synthetic_views.h"

namespace calibration {
namespace {

const cv::Size kSize(600, 400);

std::vector<TagObservation> handheld_views(int count, double sigma_px, std::mt19937& random,
                                           const Lens& lens = synthetic::narrow_lens()) {
  std::vector<TagObservation> views;
  for (const Eigen::Isometry3d& pose : synthetic::handheld_poses(count, random))
    views.push_back(synthetic::observe(lens, synthetic::board(), pose, sigma_px, random));
  return views;
}

Eigen::Matrix<double, 9, 1> parameters(const Lens& lens) {
  Eigen::Matrix<double, 9, 1> out;
  const auto& k = lens.distortion;
  out << lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, k[0], k[1], k[2], k[3], k[4];
  return out;
}

std::string error_of(const std::vector<TagObservation>& views) {
  try {
    fit_lens(views, synthetic::board(), kSize, 2400);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Lens, ExactCornersGiveTheExactLensFromHalfAndFromTwiceTheFocalLength) {
  std::mt19937 random(2);
  const auto views = handheld_views(15, 0.0, random);
  for (const double guess : {1200.0, 2400.0, 4800.0}) {
    const LensFit fit = fit_lens(views, synthetic::board(), kSize, guess);
    EXPECT_TRUE(fit.converged);
    // without noise only the weak priors on the distortion and the warp remain, and corners weigh as if known to 1e-4
    // px
    EXPECT_NEAR(fit.lens.fx_px, 2402.0, 0.05) << "from " << guess;
    EXPECT_NEAR(fit.lens.fy_px, 2397.0, 0.05);
    EXPECT_NEAR(fit.lens.cx_px, 303.0, 0.05);
    EXPECT_LT(fit.rms_px, 1e-3);
    EXPECT_EQ(fit.corners_rejected, 0);
  }
}

TEST(Lens, TheTruthLiesWithinThePredictedUncertainty) {
  std::mt19937 random(11);
  const LensFit fit = fit_lens(handheld_views(15, 0.1, random), synthetic::board(), kSize, 2400);
  EXPECT_TRUE(fit.converged);
  EXPECT_NEAR(fit.rms_px, 0.1, 0.01);
  const Eigen::Matrix<double, 8, 1> error = (parameters(fit.lens) - parameters(synthetic::narrow_lens())).head<8>();
  const Eigen::Matrix<double, 8, 8> covariance = fit.covariance.topLeftCorner<8, 8>();
  EXPECT_LT(error.dot(covariance.ldlt().solve(error)), 26.1);  // chi-square, 8 degrees of freedom, 0.1 %
  EXPECT_LT(std::abs(error[0]), 10.0);                         // 0.4 % of the focal length: boards are 110 mm at 600 mm
}

TEST(Lens, ThePredictedUncertaintyIsTheObservedSpread) {
  constexpr int kDraws = 30;
  Eigen::Matrix<double, 9, 1> observed = Eigen::Matrix<double, 9, 1>::Zero(), predicted = observed;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::mt19937 random(77);  // the same poses each time
    const auto poses = synthetic::handheld_poses(12, random);
    random.seed(static_cast<unsigned>(1000 + draw));
    std::vector<TagObservation> views;
    for (const auto& pose : poses)
      views.push_back(synthetic::observe(synthetic::narrow_lens(), synthetic::board(), pose, 0.1, random));
    const LensFit fit = fit_lens(views, synthetic::board(), kSize, 2400);
    observed += (parameters(fit.lens) - parameters(synthetic::narrow_lens())).cwiseAbs2() / kDraws;
    predicted += fit.covariance.diagonal() / kDraws;
  }
  for (int i = 0; i < 8; ++i) {
    RecordProperty("sigma_" + std::to_string(i), std::to_string(std::sqrt(predicted[i])));
    // a standard deviation from 30 draws is known to 13 %; three times that
    EXPECT_NEAR(std::sqrt(observed[i] / predicted[i]), 1.0, 0.4) << "parameter " << i;
  }
}

// The figure that matters: with the fitted lens, the same board seen again where spools stand is projected as by the
// truth.
TEST(Lens, TheLensIsGoodWhereItIsUsed) {
  std::mt19937 random(4);
  double squares = 0.0;
  int count = 0;
  for (int draw = 0; draw < 5; ++draw) {
    const LensFit fit = fit_lens(handheld_views(15, 0.1, random), synthetic::board(), kSize, 2400);
    const TagObservation exact = synthetic::observe(synthetic::narrow_lens(), synthetic::board(),
                                                    synthetic::facing(600, 0.4, 0.1, 0), 0.0, random);
    const auto pose = fit_pose(fit.lens, synthetic::board(), exact);
    ASSERT_TRUE(pose.has_value());
    squares += pose->rms_px * pose->rms_px;
    ++count;
  }
  // Corners of 15 views average to 0.01 px; a wrong model of the distortion would leave several tenths.
  EXPECT_LT(std::sqrt(squares / count), 0.05);
}

TEST(Lens, ABentBoardDoesNotBendTheFocalLength) {
  std::mt19937 random(9);
  TagLayout bent = synthetic::board();  // 0.5 mm at the middle along x, each tag at its height and slope
  for (Tag& tag : bent.tags) {
    const double u = tag.object_from_tag.translation().x() / 55.0;
    tag.object_from_tag.translation().z() = 0.5 * (1.0 - u * u);
    tag.object_from_tag.rotate(Eigen::AngleAxisd(std::atan(2.0 * 0.5 * u / 55.0), Eigen::Vector3d::UnitY()));
  }
  std::vector<TagObservation> views;
  for (const auto& pose : synthetic::handheld_poses(15, random))
    views.push_back(synthetic::observe(synthetic::narrow_lens(), bent, pose, 0.1, random));
  const LensFit fit = fit_lens(views, synthetic::board(), kSize, 2400);
  EXPECT_NEAR(fit.board_warp_mm.x(), 0.5, 0.1);  // the tags are flat, so the parabola is only nearly true
  EXPECT_NEAR(fit.lens.fx_px, 2402.0, 4.0 * std::sqrt(fit.covariance(0, 0)));
}

TEST(Lens, AStandardSolverAgreesOnTheSameCorners) {
  std::mt19937 random(21);
  const auto views = handheld_views(15, 0.1, random);
  const LensFit fit = fit_lens(views, synthetic::board(), kSize, 2400);
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  const TagLayout board = synthetic::board();
  for (const TagObservation& view : views) {
    points.emplace_back();
    pixels.emplace_back();
    for (const TagDetection& tag : view) {
      const auto corners = corners_in_object(board.tags[static_cast<std::size_t>(tag.id)]);
      for (std::size_t c = 0; c < 4; ++c) {
        points.back().emplace_back(static_cast<float>(corners[c].x()), static_cast<float>(corners[c].y()), 0.0F);
        pixels.back().emplace_back(static_cast<float>(tag.corners_px[c].x()),
                                   static_cast<float>(tag.corners_px[c].y()));
      }
    }
  }
  cv::Matx33d matrix(2400, 0, 299.5, 0, 2400, 199.5, 0, 0, 1);
  cv::Mat distortion = cv::Mat::zeros(1, 5, CV_64F);
  std::vector<cv::Mat> rotations, translations;
  const double rms = cv::calibrateCamera(points, pixels, kSize, matrix, distortion, rotations, translations,
                                         cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_K3);
  EXPECT_NEAR(rms / std::sqrt(2.0), fit.rms_px, 0.002);  // it reports both axes together
  // it knows no warp, so the two differ by a part of the uncertainty that the warp adds
  EXPECT_NEAR(matrix(0, 0), fit.lens.fx_px, 3.0 * std::sqrt(fit.covariance(0, 0)));
  EXPECT_NEAR(matrix(0, 2), fit.lens.cx_px, 3.0 * std::sqrt(fit.covariance(2, 2)));
}

TEST(Lens, WrongCornersAreRejectedAndCounted) {
  std::mt19937 random(13);
  auto views = handheld_views(12, 0.1, random);
  const LensFit clean = fit_lens(views, synthetic::board(), kSize, 2400);
  views[3][1].corners_px[2].x() += 30.0;
  views[7][0].corners_px[0].y() -= 8.0;
  const LensFit fit = fit_lens(views, synthetic::board(), kSize, 2400);
  EXPECT_GE(fit.corners_rejected, 2);
  EXPECT_LE(fit.corners_rejected, clean.corners_rejected + 3);
  EXPECT_NEAR(fit.rms_px, clean.rms_px, 0.005);
  EXPECT_NEAR(fit.lens.fx_px, clean.lens.fx_px, std::sqrt(clean.covariance(0, 0)));
}

TEST(Lens, ViewsThatCannotDetermineALensAreRefusedInOneLine) {
  std::mt19937 random(3);
  const auto good = handheld_views(8, 0.1, random);
  EXPECT_NE(error_of({good[0]}).find("at least 5"), std::string::npos);
  EXPECT_NE(error_of({}).find("at least 5"), std::string::npos);
  std::vector<TagObservation> alike, corner_only;
  for (int i = 0; i < 8; ++i) {
    alike.push_back(synthetic::observe(synthetic::narrow_lens(), synthetic::board(),
                                       synthetic::facing(500 + 30 * i, 0.02 * i, 0, 0, {4.0 * i, 0}), 0.1, random));
    const TagLayout small = make_tag_board("test board", 1, 2, 12.0, 18.0, 0);
    corner_only.push_back(synthetic::observe(synthetic::narrow_lens(), small,
                                             synthetic::facing(700, 0.1 * i, -0.05 * i, 0, {-60, -35}), 0.1, random));
  }
  EXPECT_NE(error_of(alike).find("tilt"), std::string::npos);
  EXPECT_THROW(fit_lens(corner_only, make_tag_board("test board", 1, 2, 12.0, 18.0, 0), kSize, 2400),
               std::runtime_error);
  auto broken = good;
  broken[2][0].corners_px[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_of(broken).find("finite"), std::string::npos);
  EXPECT_THROW(fit_lens(good, synthetic::board(), kSize, 0.0), std::runtime_error);
}

// Faults of boards and pictures, each with the one line that it gets.

std::vector<TagObservation> with_ids(std::vector<TagObservation> views, const std::map<int, int>& exchanged) {
  for (TagObservation& view : views)
    for (TagDetection& tag : view)
      if (const auto found = exchanged.find(tag.id); found != exchanged.end()) tag.id = found->second;
  return views;
}

TEST(Lens, ExchangedTagsAreRefusedByName) {
  std::mt19937 random(5);
  const std::string message = error_of(with_ids(handheld_views(10, 0.1, random), {{2, 9}, {9, 2}}));
  EXPECT_NE(message.find("tags 2, 9"), std::string::npos) << message;
  EXPECT_NE(message.find("exchanged"), std::string::npos) << message;
}

TEST(Lens, AMirroredBoardIsRefused) {
  std::mt19937 random(6);
  auto views = handheld_views(10, 0.1, random);
  for (TagObservation& view : views)
    for (TagDetection& tag : view)
      for (Eigen::Vector2d& corner : tag.corners_px) corner.x() = kSize.width - 1 - corner.x();
  EXPECT_NE(error_of(views).find("mirrored"), std::string::npos) << error_of(views);
}

TEST(Lens, ABoardWhoseIdsRunAnotherWayIsRefused) {
  std::mt19937 random(7);
  std::map<int, int> along_columns;  // counted down the columns instead of along the rows
  for (int id = 0; id < 12; ++id) along_columns[id] = (id % 4) * 3 + id / 4;
  const std::string message = error_of(with_ids(handheld_views(10, 0.1, random), along_columns));
  EXPECT_NE(message.find("board"), std::string::npos) << message;
  EXPECT_NE(message.find("check"), std::string::npos) << message;
}

TEST(Lens, ABoardTurnedUpsideDownGivesTheSameLens) {
  std::mt19937 random(8);
  const auto poses = synthetic::handheld_poses(12, random);
  std::vector<TagObservation> upright, turned;
  for (const Eigen::Isometry3d& pose : poses) {
    upright.push_back(synthetic::observe(synthetic::narrow_lens(), synthetic::board(), pose, 0.0, random));
    turned.push_back(synthetic::observe(synthetic::narrow_lens(), synthetic::board(),
                                        pose * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()), 0.0,
                                        random));
  }
  const LensFit a = fit_lens(upright, synthetic::board(), kSize, 2400);
  const LensFit b = fit_lens(turned, synthetic::board(), kSize, 2400);
  EXPECT_NEAR(a.lens.fx_px, b.lens.fx_px, 1e-3);
  EXPECT_NEAR(a.lens.cx_px, b.lens.cx_px, 1e-3);
}

TEST(Lens, SizesWrongByTenChangeOnlyTheDistanceWhichTheTapeMeasureShows) {
  std::mt19937 random(9);
  const auto views = handheld_views(12, 0.1, random);
  const LensFit right = fit_lens(views, synthetic::board(), kSize, 2400, {.taped_distance_mm = 600});
  EXPECT_TRUE(all_passed(right.gates));
  const LensFit wrong =
      fit_lens(views, make_tag_board("test board", 3, 4, 200.0, 300.0, 0), kSize, 2400, {.taped_distance_mm = 600});
  EXPECT_NEAR(wrong.lens.fx_px, right.lens.fx_px, 0.01);
  int failed = 0;
  for (const Gate& gate : wrong.gates) {
    if (gate.passed) continue;
    ++failed;
    EXPECT_NE(gate.name.find("tape measure"), std::string::npos) << gate.name;
    EXPECT_NEAR(gate.value, 10.0, 2.0);
  }
  EXPECT_EQ(failed, 1);
}

// A shift of the principal point or another focal length alone would do no harm in a picture so narrow: poses take it.
TEST(Lens, AnotherLensInEverySecondViewIsShownByTheHalves) {
  std::mt19937 random(10);
  auto views = handheld_views(20, 0.05, random);
  Lens other = synthetic::narrow_lens();
  other.distortion = {2.0, 0.6, 0.0, 0.0, 0.0};
  const auto later = handheld_views(20, 0.05, random, other);
  for (std::size_t v = 1; v < views.size(); v += 2) views[v] = later[v];
  const LensFit fit = fit_lens(views, synthetic::board(), kSize, 2400);
  ASSERT_TRUE(fit.halves.has_value());
  const auto halves = std::find_if(fit.gates.begin(), fit.gates.end(),
                                   [](const Gate& gate) { return gate.name.starts_with("half of the pictures"); });
  ASSERT_NE(halves, fit.gates.end());
  EXPECT_FALSE(halves->passed) << halves->value;
  EXPECT_TRUE(all_passed(fit_lens(handheld_views(20, 0.05, random), synthetic::board(), kSize, 2400).gates));
}

// Poses take up what another focal length does to pictures so narrow: no half contradicts the other in the picture.
TEST(Lens, AFocusThatMovedHalfWayIsShownByTheFocalLengths) {
  std::mt19937 random(17);
  auto views = handheld_views(20, 0.05, random);
  Lens other = synthetic::narrow_lens();
  other.fx_px *= 1.04, other.fy_px *= 1.04;
  const auto later = handheld_views(20, 0.05, random, other);
  for (std::size_t v = 10; v < views.size(); ++v) views[v] = later[v];
  const auto focal = [](const LensFit& fit) {
    return *std::ranges::find_if(fit.gates,
                                 [](const Gate& gate) { return gate.name.starts_with("focal length of half"); });
  };
  const Gate moved = focal(fit_lens(views, synthetic::board(), kSize, 2400));
  EXPECT_FALSE(moved.passed) << moved.value;
  EXPECT_TRUE(focal(fit_lens(later, synthetic::board(), kSize, 2400)).passed);
}

TEST(Lens, ABoardWithoutACommonLatticeIsRefused) {
  TagLayout crooked = synthetic::board();
  crooked.tags[5].object_from_tag.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  EXPECT_THROW(lattice_of(crooked), std::runtime_error);
  const TagLattice regular = lattice_of(synthetic::board());  // tags of 20 mm, gaps of 10 mm
  EXPECT_NEAR(regular.lattice.spacing_mm, 10.0, 1e-12);
  EXPECT_EQ(regular.lattice.columns, 12);
  EXPECT_EQ(regular.lattice.rows, 9);
}

TEST(Lens, TheFocalLengthIsGuessedFromPerspectiveToAFactorOfTwo) {
  std::mt19937 random(12);
  const TagLattice tags = lattice_of(synthetic::board());
  std::vector<BoardPicture> views;
  for (const TagObservation& view : handheld_views(10, 0.1, random))
    views.push_back(on_lattice(tags, synthetic::board(), view));
  const double guess = guess_focal_px(views, tags.lattice, kSize);
  EXPECT_GT(guess, 1200);
  EXPECT_LT(guess, 4800);
}

TEST(Lens, UndistortedPointsAreThoseOfAPinholeWithTheSameMatrix) {
  const Lens lens = synthetic::narrow_lens();
  Lens pinhole = lens;
  pinhole.distortion = {};
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(60, 40, 600), Eigen::Vector3d(-55, 30, 500), Eigen::Vector3d(0, 0, 600)}) {
    const Eigen::Vector2d straight = undistort_points(lens, {synthetic::project(lens, point)}).front();
    EXPECT_LT((straight - synthetic::project(pinhole, point)).norm(), 1e-6);
  }
  EXPECT_TRUE(undistort_points(lens, {}).empty());
}

}  // namespace
}  // namespace calibration
