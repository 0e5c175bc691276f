// Lens calibration from the corners seen in pictures of a printed board: intrinsics with residuals, covariance and
// acceptance checks.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/lattice.h"
#include "calibration/geometry/lens.h"
#include "calibration/geometry/lens_difference.h"
#include "calibration/geometry/tags.h"
#include "calibration/sensor/gate.h"

namespace calibration {

struct CornerError {
  int picture = 0;                                     // index among the pictures that were given
  LatticeCorner corner;                                // as seen
  Eigen::Vector2d error_px = Eigen::Vector2d::Zero();  // predicted - seen; 0 when the corner was not used
  bool used = true;
};

struct LensOptions {
  // The distance at which the lens will be used; uncertainties and differences hold there. 0: the pictures' median
  // distance.
  double working_distance_mm = 0.0;
  // The typical distance of the board from the camera by tape measure, to check the printed sizes. 0: not known.
  double taped_distance_mm = 0.0;
};

struct LensFit {
  Lens lens;
  double rms_px = 0.0;         // per axis, over the corners used
  Eigen::MatrixXd covariance;  // 9 x 9: fx fy cx cy k1 k2 p1 p2 k3 (pixels where they have units), for the noise that
                               // the residuals show
  // One per picture; 0 for a picture with fewer than eight corners, which is left out.
  std::vector<double> picture_rms_px;
  // How far the board's middle stands out of the plane of its edges, along its x and its y, mm, with standard errors;
  // positive: towards the viewer. (mrcal's own tools count a board's rows downwards, so that its z points away from the
  // viewer: their calobject_warp of the same board has the other sign.)
  Eigen::Vector2d board_warp_mm = Eigen::Vector2d::Zero(), board_warp_sigma_mm = Eigen::Vector2d::Zero();
  int corners_used = 0;
  int corners_rejected = 0;  // off by more than a lattice spacing, or by mrcal's rule: 5 sigma, then 4 sigma
  bool converged = false;

  Lattice lattice;                                                    // the board's lattice
  std::vector<CornerError> corner_errors;                             // of all pictures that are not left out
  std::vector<std::optional<Eigen::Isometry3d>> camera_from_lattice;  // one per picture

  // Standard error of projections at the working distance, in the worse direction, px; kGridRows x kGridColumns.
  double working_distance_mm = 0.0;
  Eigen::MatrixXd projection_sigma_px;

  // mrcal's regularisation pulls distortion towards 0. The fit starts with it and ends without it, unless the lens
  // would then be undetermined (`regularised`). `regularisation` is what it would have changed; `regularisation_sigmas`
  // is the largest of these changes in standard errors.
  bool regularised = false;
  LensDifference regularisation;
  double regularisation_sigmas = 0.0;    // above 3, regularisation would have bent the lens
  LensDifference opencv8;                // difference from a fit of a lens with twelve parameters to the same pictures
  std::optional<LensDifference> halves;  // difference of fits to even and to odd pictures; absent for fewer than ten
  // Part of the focal length, in %, by which halves of the pictures differ beyond what five of its standard errors
  // explain: the worse of even and odd pictures and of the first and the second half. Absent likewise.
  std::optional<double> focal_change_percent;
  std::vector<Gate> gates;  // the lens is accepted when all passed
  std::string messages;     // what the solver printed
};

// The rms of projection_sigma_px over the inner two thirds of rows and columns, where spools stand. At the picture's
// corners, which boards seldom reach, the values are extrapolations and are left out.
double middle_sigma_px(const LensFit& fit);

// Whether more pictures are not worth a person's while: all gates passed, and middle_sigma_px is at most kWellKnown_px,
// a tenth of what is allowed.
inline constexpr double kWellKnown_px = 0.03;
bool is_well_known(const LensFit& fit);

// A first guess of the focal length from the perspective of the pictures, good to a factor of two unless all boards are
// seen from the front; the picture's width when the pictures show no perspective.
double guess_focal_px(const std::vector<BoardPicture>& pictures, const Lattice& board, cv::Size image_size);

// Fits a lens to pictures of a board. `focal_guess_px`: from EXIF or the rig file, good to a factor of two. Throws
// std::runtime_error when the pictures cannot determine a lens (too few, all alike) or contradict the board (mirrored,
// tags exchanged, other sizes), saying what is wrong and what to do. A chessboard seen upside down is the same board.
LensFit fit_lens(const std::vector<BoardPicture>& pictures, const Lattice& board, cv::Size image_size,
                 double focal_guess_px, const LensOptions& options = {});
LensFit fit_lens(const std::vector<TagObservation>& pictures, const TagLayout& board, cv::Size image_size,
                 double focal_guess_px, const LensOptions& options = {});

}  // namespace calibration
