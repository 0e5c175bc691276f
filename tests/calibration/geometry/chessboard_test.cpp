#include "calibration/geometry/chessboard.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/geometry/lens_fit.h"
#include "tests/calibration/geometry/synthetic_views.h"

namespace calibration {
namespace {

const std::string kPhotographs = "/usr/share/doc/opencv-doc/examples/data/";  // Debian's opencv-doc

std::vector<BoardPicture> photographed_corners(const std::string& side) {
  std::vector<BoardPicture> views;
  for (int number = 1; number <= 14; ++number) {
    const std::string file = kPhotographs + side + (number < 10 ? "0" : "") + std::to_string(number) + ".jpg";
    if (!std::filesystem::exists(file)) continue;  // there is no tenth
    const auto view = find_chessboard(cv::imread(file, cv::IMREAD_GRAYSCALE), 9, 6);
    EXPECT_TRUE(view.has_value()) << file;
    if (view) views.push_back(*view);
  }
  return views;
}

// mrcal's own command-line tool, on corners found with the same method, gives f 533.160 / 533.336, centre 342.381 /
// 233.988 px and 0.133 px per axis (OPENCV5, warp, regularisation).
TEST(Chessboard, PhotographsOfAnotherCameraGiveTheLensThatMrcalsOwnToolGives) {
  ASSERT_TRUE(std::filesystem::exists(kPhotographs)) << "install opencv-doc, as station/packages.txt says";
  const std::vector<BoardPicture> views = photographed_corners("left");
  ASSERT_EQ(views.size(), 13U);
  const Lattice board{.columns = 9, .rows = 6, .spacing_mm = 25.0};
  const LensFit fit = fit_lens(views, board, {640, 480}, guess_focal_px(views, board, {640, 480}));
  EXPECT_TRUE(fit.converged);
  for (const Gate& gate : fit.gates)
    EXPECT_TRUE(gate.passed) << gate.name << " " << gate.value << ", limit " << gate.limit;
  RecordProperty("focal_length_px", std::to_string(fit.lens.fx_px));
  EXPECT_NEAR(fit.lens.fx_px, 533.16, 0.2);
  EXPECT_NEAR(fit.lens.fy_px, 533.34, 0.2);
  EXPECT_NEAR(fit.lens.cx_px, 342.38, 0.2);
  EXPECT_NEAR(fit.lens.cy_px, 233.99, 0.2);
  EXPECT_NEAR(fit.rms_px, 0.133, 0.002);
  EXPECT_EQ(fit.corners_rejected, 0);
}

// 9 x 6 inner corners, each square 20 px or more in the picture.
TEST(Chessboard, CornersOfARenderedBoardAreWhereItsLatticeSays) {
  const Lens lens = synthetic::narrow_lens();
  const Lattice board{.columns = 9, .rows = 6, .spacing_mm = 10.0};
  const Eigen::Isometry3d pose = synthetic::facing(600, 0.3, -0.2, 0.1) * Eigen::Translation3d(-board.point(8, 5) / 2);
  const Eigen::Isometry3d lattice_from_camera = pose.inverse();
  constexpr int kFine = 5;
  cv::Mat1f fine(lens.height_px * kFine, lens.width_px * kFine, 0.7F);
  Lens straight = lens;  // squares are drawn by a pinhole
  straight.distortion = {};
  for (int row = 0; row < fine.rows; ++row)
    for (int column = 0; column < fine.cols; ++column) {
      const Eigen::Vector3d direction =
          lattice_from_camera.linear() * Eigen::Vector3d(((column + 0.5) / kFine - 0.5 - lens.cx_px) / lens.fx_px,
                                                         ((row + 0.5) / kFine - 0.5 - lens.cy_px) / lens.fy_px, 1.0);
      const Eigen::Vector3d hit =
          lattice_from_camera.translation() - direction * lattice_from_camera.translation().z() / direction.z();
      const int i = static_cast<int>(std::floor(hit.x() / 10.0)), j = static_cast<int>(std::floor(hit.y() / 10.0));
      if (i >= -1 && j >= -1 && i <= 8 && j <= 5 && (i + j) % 2 == 0) fine(row, column) = 0.05F;
    }
  cv::Mat1f grey;
  cv::resize(fine, grey, {lens.width_px, lens.height_px}, 0, 0, cv::INTER_AREA);
  cv::Mat1b display;
  grey.convertTo(display, CV_8U, 255.0);
  const auto seen = find_chessboard(display, 9, 6);
  ASSERT_TRUE(seen.has_value());
  ASSERT_EQ(seen->size(), 54U);
  const bool half_turn =
      (seen->front().pixel - synthetic::project(straight, pose * board.point(seen->front().column, seen->front().row)))
          .norm() > 10.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const LatticeCorner& corner : *seen) {
    const int column = half_turn ? 8 - corner.column : corner.column, row = half_turn ? 5 - corner.row : corner.row;
    const Eigen::Vector2d error = corner.pixel - synthetic::project(straight, pose * board.point(column, row));
    EXPECT_LT(error.norm(), 0.15);
    mean += error / 54.0;
  }
  EXPECT_LT(mean.norm(), 0.03);  // half a pixel if a convention were mistaken
}

TEST(Chessboard, APictureWithoutAChessboardHasNone) {
  EXPECT_FALSE(find_chessboard(cv::Mat1b(), 9, 6));
  EXPECT_FALSE(find_chessboard(cv::Mat1b(100, 120, uchar{128}), 9, 6));
}

}  // namespace
}  // namespace calibration
