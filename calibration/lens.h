// Lens calibration from views of a printed board: pictures' corners in, intrinsics with residuals, covariance and
// acceptance checks out.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/gate.h"
#include "calibration/lattice.h"
#include "calibration/tags.h"

namespace calibration {

// OPENCV5 lens (k3 is 0 for fields of view too narrow to show it): pixels, centre of the first pixel at (0, 0).
struct Lens {
  int width_px = 0, height_px = 0;
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, 5> distortion{};  // k1 k2 p1 p2 k3
};

struct CornerError {
  int view = 0;                                        // among the views that were given
  LatticeCorner corner;                                // as seen
  Eigen::Vector2d error_px = Eigen::Vector2d::Zero();  // predicted - seen; 0 where it was not used
  bool used = true;
};

// Two lenses compared over the inner two thirds of rows and columns, after the rigid motion between their cameras that
// fits best there: how far apart they project the same points at one distance, px.
struct LensDifference {
  double median_px = 0.0, rms_px = 0.0, largest_px = 0.0;
};

struct LensOptions {
  // Where the lens will be used: uncertainties and differences are meant there. 0: the median distance of the views.
  double working_distance_mm = 0.0;
  // Typical distance of the board from the camera by tape measure, for checking the printed sizes. 0: not known.
  double taped_distance_mm = 0.0;
};

// The uncertainty of projections is given at this many positions, spread evenly from the first to the last pixel.
constexpr int kGridColumns = 12, kGridRows = 9;

struct LensFit {
  Lens lens;
  double rms_px = 0.0;         // per axis, over the corners used
  Eigen::MatrixXd covariance;  // 9 x 9: fx fy cx cy k1 k2 p1 p2 k3 (pixels where they have units), for the noise that
                               // the residuals show
  std::vector<double> view_rms_px;  // one per view; 0 for a view with fewer than eight corners, which is left out
  // How far the board's middle stands out of the plane of its edges, along its x and its y, mm, with standard errors.
  Eigen::Vector2d board_warp_mm = Eigen::Vector2d::Zero(), board_warp_sigma_mm = Eigen::Vector2d::Zero();
  int corners_used = 0;
  int corners_rejected = 0;  // off by more than a lattice spacing, or by mrcal's rule: 5 sigma, then 4 sigma
  bool converged = false;

  Lattice lattice;                                                    // of the board
  std::vector<CornerError> corner_errors;                             // of the views that are not left out
  std::vector<std::optional<Eigen::Isometry3d>> camera_from_lattice;  // one per view

  // Standard error of projections at the working distance (worse direction), px; kGridRows x kGridColumns.
  double working_distance_mm = 0.0;
  Eigen::MatrixXd projection_sigma_px;

  // mrcal's regularisation pulls distortion towards 0. The fit starts with it and ends without, unless the views leave
  // the lens undetermined then (`regularised`). What it would have changed, and at most in standard errors:
  bool regularised = false;
  LensDifference regularisation;
  double regularisation_sigmas = 0.0;    // above 3 it would have bent the lens
  LensDifference opencv8;                // the same views with a lens of twelve parameters
  std::optional<LensDifference> halves;  // even against odd views; absent for fewer than ten
  std::vector<Gate> gates;               // accepted when all passed
  std::string messages;                  // of the solver
};

// Rms of projection_sigma_px over the inner two thirds of rows and columns, where spools stand: at the picture's corners,
// which boards seldom reach, it is an extrapolation.
double middle_sigma_px(const LensFit& fit);

// From the perspective of the views alone, good to a factor of two unless all are seen from the front; the width of the
// picture where they do not show it.
double guess_focal_px(const std::vector<LatticeView>& views, const Lattice& board, cv::Size image_size);

// Board views -> lens. `focal_guess_px` from EXIF or the rig file, good to a factor of two. Throws std::runtime_error
// when the views cannot determine a lens (too few, all alike) or contradict the board (mirrored, tags exchanged,
// other sizes), saying what is wrong and what to do. A chessboard seen upside down is the same board.
LensFit fit_lens(const std::vector<LatticeView>& views, const Lattice& board, cv::Size image_size,
                 double focal_guess_px, const LensOptions& options = {});
LensFit fit_lens(const std::vector<TagObservation>& views, const TagLayout& board, cv::Size image_size,
                 double focal_guess_px, const LensOptions& options = {});

// Pixel positions with the distortion removed (same intrinsic matrix, zero distortion).
std::vector<Eigen::Vector2d> undistort_points(const Lens& lens, const std::vector<Eigen::Vector2d>& pixels);

}  // namespace calibration
