#include "calibration/geometry/lens_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "calibration/geometry/lens_difference.h"
#include "calibration/geometry/mrcal_lens.h"
#include "calibration/geometry/pose.h"
#include "calibration/sensor/degree.h"
#include "calibration/sensor/median.h"

namespace calibration {
namespace {

constexpr int kFewestPictures = 5;
constexpr int kFewestPicturesToHalve = 10;
constexpr std::size_t kFewestCornersPerPicture = 8;
constexpr double kSmallestTilt_deg = 20.0;
constexpr int kFewestFields = 6;
constexpr double kFinest_px = 0.01;  // finer than corners can be found; smaller errors mean nothing

[[noreturn]] void refuse_lens(const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("lens calibration: " + found + ": " + what_to_do);
}

struct UsedPictures {
  LensBundle bundle;
  std::vector<std::size_t> index;  // place of each of the bundle's pictures among those that were given
};

Lens seed_lens(const cv::Size& size, double focal_px) {
  return {.width_px = size.width,
          .height_px = size.height,
          .fx_px = focal_px,
          .fy_px = focal_px,
          .cx_px = 0.5 * (size.width - 1),
          .cy_px = 0.5 * (size.height - 1)};
}

// The pictures with enough corners, each with a pose for the guessed lens. Corners more than a lattice spacing off are
// left unused from the start, because they would bend the first solution, by which outliers are judged.
UsedPictures gather(const std::vector<BoardPicture>& given, const Lattice& board, const cv::Size& size,
                    double focal_px) {
  if (size.width < 2 || size.height < 2 || !(focal_px > 0.0) || !std::isfinite(focal_px))
    refuse_lens("needs the size of the pictures and a positive guess of the focal length", "check the rig file");
  UsedPictures pictures;
  pictures.bundle.lattice = board;
  const Lens lens = seed_lens(size, focal_px);
  pictures.bundle.lens = {.model = LensModel::opencv5,
                          .image_size = size,
                          .intrinsics = {focal_px, focal_px, lens.cx_px, lens.cy_px, 0, 0, 0, 0, 0}};
  int mirrored = 0, contradictory = 0, seen = 0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    for (const LatticeCorner& corner : given[i])
      if (!corner.pixel.allFinite())
        refuse_lens("picture " + std::to_string(i + 1) + " has a corner whose position is not a finite number",
                    "detect its corners again");
    if (given[i].size() < kFewestCornersPerPicture) continue;
    ++seen;
    const std::optional<BoardCheck> check = check_board(given[i]);
    contradictory += check ? 0 : 1;
    if (!check) continue;
    mirrored += check->mirrored ? 1 : 0;
    BundlePicture picture{.corners = given[i], .used = {}};
    std::vector<Corner> matched;
    for (std::size_t c = 0; c < given[i].size(); ++c) {
      picture.used.push_back(!check->displaced[c]);
      if (picture.used[c]) matched.push_back({board.point(given[i][c].column, given[i][c].row), given[i][c].pixel});
    }
    const std::optional<PoseFit> pose = fit_pose(lens, matched);
    if (!pose) continue;
    picture.camera_from_lattice = pose->camera_from_object;
    pictures.bundle.pictures.push_back(picture);
    pictures.index.push_back(i);
  }
  if (2 * mirrored > seen)
    refuse_lens("the board is seen mirrored, right and left exchanged, in " + std::to_string(mirrored) + " of " +
                    std::to_string(seen) + " pictures",
                "print it again without mirroring, or take pictures that were not flipped");
  if (2 * contradictory > seen)
    refuse_lens("the corners of " + std::to_string(contradictory) + " of " + std::to_string(seen) +
                    " pictures do not lie as on the board",
                "check that the board file is the one of this print: rows, columns and first id");
  return pictures;
}

// The largest angle between the board's normals in two pictures.
double tilt_spread_deg(const LensBundle& bundle) {
  double largest = 0.0;
  for (const BundlePicture& a : bundle.pictures) {
    for (const BundlePicture& b : bundle.pictures) {
      const double cosine = a.camera_from_lattice.linear().col(2).dot(b.camera_from_lattice.linear().col(2));
      largest = std::max(largest, std::acos(std::clamp(cosine, -1.0, 1.0)));
    }
  }
  return largest / kDegree;
}

// The number of the picture's 3 x 3 fields in which corners were seen.
int covered_fields(const LensBundle& bundle) {
  std::set<int> fields;
  for (const BundlePicture& picture : bundle.pictures) {
    for (const LatticeCorner& corner : picture.corners) {
      const int column = std::clamp(static_cast<int>(3.0 * corner.pixel.x() / bundle.lens.image_size.width), 0, 2);
      const int row = std::clamp(static_cast<int>(3.0 * corner.pixel.y() / bundle.lens.image_size.height), 0, 2);
      fields.insert(3 * row + column);
    }
  }
  return static_cast<int>(fields.size());
}

// Throws when the pictures cannot determine a lens, which mrcal does not notice: it returns numbers from a single
// picture.
std::vector<Gate> require_determined(const UsedPictures& pictures) {
  const auto count = static_cast<int>(pictures.bundle.pictures.size());
  if (count < kFewestPictures)
    refuse_lens("the board is seen in " + std::to_string(count) + " pictures, at least " +
                    std::to_string(kFewestPictures) + " with eight corners (two tags) each are needed",
                "take more pictures of the board");
  const double tilt_deg = tilt_spread_deg(pictures.bundle);
  if (tilt_deg < kSmallestTilt_deg)
    refuse_lens(
        "the board's tilts differ by " + std::to_string(std::lround(tilt_deg)) + " degrees at most, 20 are needed",
        "tilt the board to 30 or 40 degrees in several directions");
  const int fields = covered_fields(pictures.bundle);
  if (fields < kFewestFields)
    refuse_lens("corners lie in " + std::to_string(fields) + " of the picture's 3 x 3 fields, 6 are needed",
                "bring the board to the picture's edges too");
  return {at_least("pictures with the board", count, kFewestPictures, "fewer leave the lens undetermined; take more"),
          at_least("spread of the board's tilts, deg", tilt_deg, kSmallestTilt_deg,
                   "pictures alike leave focal length and distance undetermined; tilt the board more"),
          at_least("fields of the picture with corners, of 9", fields, kFewestFields,
                   "distortion is known only where corners were seen; bring the board to the edges")};
}

Eigen::Vector2d predicted(const LensBundle& bundle, const BundlePicture& picture, const LatticeCorner& corner) {
  const double u = static_cast<double>(corner.column) / (bundle.lattice.columns - 1);
  const double v = static_cast<double>(corner.row) / (bundle.lattice.rows - 1);
  Eigen::Vector3d point = bundle.lattice.point(corner.column, corner.row);
  point.z() = 4.0 * (bundle.warp_mm.x() * u * (1.0 - u) + bundle.warp_mm.y() * v * (1.0 - v));
  return project_with(bundle.lens, picture.camera_from_lattice * point);
}

// Solves with regularisation in two stages: first a pinhole, by which outliers cannot be judged yet, then the whole
// lens.
BundleOutcome solve_in_stages(LensBundle& bundle) {
  solve_bundle(bundle, {.distortion = false, .warp = false, .regularised = true, .reject_outliers = false});
  return solve_bundle(bundle, {});
}

// Uses corners again that now fit as well as the others; they were judged outliers while regularisation bent the lens.
// Returns whether there were any.
bool take_back(LensBundle& bundle, double sigma_px) {
  bool any = false;
  for (BundlePicture& picture : bundle.pictures)
    for (std::size_t c = 0; c < picture.corners.size(); ++c) {
      const LatticeCorner& corner = picture.corners[c];
      const double error_px = (predicted(bundle, picture, corner) - corner.pixel).norm();
      if (!picture.used[c] && error_px < std::max(4.0 * sigma_px, kFinest_px)) any = picture.used[c] = true;
    }
  return any;
}

bool sane(const LensBundle& bundle, const BundleOutcome& outcome) {
  const double f = bundle.lens.intrinsics[0], size = bundle.lens.image_size.width + bundle.lens.image_size.height;
  return outcome.finite && f > 0.05 * size && f < 1000.0 * size && bundle.lens.intrinsics[1] > 0.0;
}

bool converged(const BundleUncertainty& uncertainty) {
  return uncertainty.covariance.allFinite() && uncertainty.step_px < 0.05 * std::max(uncertainty.sigma_px, kFinest_px);
}

double worse_sigma_px(const Eigen::Matrix2d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues()[1]);
}

std::vector<double> sigmas_over_picture(const LensBundle& bundle, const BundleUncertainty& uncertainty,
                                        double distance_mm) {
  std::vector<double> sigmas;
  for (const Eigen::Vector2d& pixel : picture_grid(bundle.lens.image_size))
    sigmas.push_back(worse_sigma_px(projection_covariance(bundle, uncertainty, pixel, distance_mm)));
  return sigmas;
}

double median_distance_mm(const LensBundle& bundle) {
  const Eigen::Vector3d middle = 0.5 * bundle.lattice.point(bundle.lattice.columns - 1, bundle.lattice.rows - 1);
  std::vector<double> distances;
  for (const BundlePicture& picture : bundle.pictures)
    distances.push_back((picture.camera_from_lattice * middle).norm());
  return median(std::move(distances));
}

struct HalvesCompared {
  LensDifference difference;
  double focal_change_percent = 0;  // LensFit
};

// The lenses from those pictures that are `chosen` and from the others, each fitted from the solution of the whole set.
// The sigma of their difference is about twice that of the whole set's lens.
std::optional<HalvesCompared> compare_halves(const LensBundle& whole, bool regularised, double distance_mm,
                                             const std::function<bool(std::size_t)>& chosen) {
  constexpr double kSurely = 5;  // standard errors
  const BundleFreedom freedom{.regularised = regularised, .reject_outliers = false};
  std::array<LensBundle, 2> halves{whole, whole};
  double variance = 0;
  for (std::size_t h = 0; h < 2; ++h) {
    halves[h].pictures.clear();
    for (std::size_t v = 0; v < whole.pictures.size(); ++v)
      if (chosen(v) == (h == 0)) halves[h].pictures.push_back(whole.pictures[v]);
    if (!sane(halves[h], solve_bundle(halves[h], freedom))) return std::nullopt;
    variance += linearise(halves[h], freedom).covariance(0, 0);
  }
  const double f = halves[0].lens.intrinsics[0], other = halves[1].lens.intrinsics[0];
  return HalvesCompared{
      .difference = summary(projection_differences(halves[0].lens, halves[1].lens, distance_mm)),
      .focal_change_percent = 100 * std::max(0.0, std::abs(f - other) - kSurely * std::sqrt(variance)) / f};
}

void compare_halves(const LensBundle& whole, LensFit& fit) {
  const std::size_t count = whole.pictures.size();
  if (static_cast<int>(count) < kFewestPicturesToHalve) return;
  const auto compared = [&](const std::function<bool(std::size_t)>& chosen) {
    const auto halves = compare_halves(whole, fit.regularised, fit.working_distance_mm, chosen);
    if (halves) fit.focal_change_percent = std::max(fit.focal_change_percent.value_or(0), halves->focal_change_percent);
    return halves;
  };
  if (const auto halves = compared([](std::size_t v) { return v % 2 == 0; })) fit.halves = halves->difference;
  compared([&](std::size_t v) { return 2 * v < count; });
}

// The model that the field of view can determine: without k3 in a narrow picture. There k3 moves nothing that k2 does
// not (0.004 px per unit at a half diagonal of 0.15 focal lengths); left free, it scatters by hundreds, and k2 with it.
LensModel determinable_model(const ModelledLens& lens) {
  const double half_diagonal = 0.5 * std::hypot(lens.image_size.width, lens.image_size.height);
  return half_diagonal / lens.intrinsics[0] < 0.2 ? LensModel::opencv4 : LensModel::opencv5;
}

// Goes on from the regularised solution, which is stable, to the one without regularisation, which is unbiased. With
// 600 x 400 px, f 2400 px, 15 pictures at 0.1 px and k2 of 0.6 / 3 / -17, projections in the inner picture are off by
// 0.022 / 0.024 / 0.045 px rms with regularisation and by 0.023 / 0.023 / 0.021 px without
// (tests/calibration/geometry/lens_accuracy_test.cpp). The pull of regularisation also makes the covariance of the
// coefficients meaningless.
void let_go_of_regularisation(LensBundle& bundle, BundleUncertainty& uncertainty, LensFit& fit) {
  uncertainty = linearise(bundle, {});
  fit.regularised = true;
  LensBundle free = bundle;
  free.lens = as(determinable_model(bundle.lens), bundle.lens);
  const BundleFreedom without{.regularised = false, .reject_outliers = false};
  if (!sane(free, solve_bundle(free, without))) return;
  BundleUncertainty free_uncertainty = linearise(free, without);
  if (take_back(free, free_uncertainty.sigma_px) && sane(free, solve_bundle(free, without)))
    free_uncertainty = linearise(free, without);
  if (!converged(free_uncertainty)) return;
  const std::vector<double> shifts = projection_differences(bundle.lens, free.lens, fit.working_distance_mm);
  const std::vector<double> sigmas = sigmas_over_picture(free, free_uncertainty, fit.working_distance_mm);
  fit.regularisation = summary(shifts);
  for (std::size_t i = 0; i < shifts.size(); ++i)
    fit.regularisation_sigmas = std::max(fit.regularisation_sigmas, shifts[i] / sigmas[i]);
  fit.regularised = false;
  bundle = free;
  uncertainty = free_uncertainty;
}

void compare_with_opencv8(const LensBundle& bundle, LensFit& fit) {
  LensBundle richer = bundle;
  richer.lens = as(LensModel::opencv8, bundle.lens);
  fit.opencv8.rms_px = fit.opencv8.largest_px = fit.opencv8.median_px = std::numeric_limits<double>::infinity();
  if (sane(richer, solve_bundle(richer, {.reject_outliers = false})))
    fit.opencv8 = summary(projection_differences(bundle.lens, richer.lens, fit.working_distance_mm));
}

void report(const UsedPictures& pictures, const BundleUncertainty& uncertainty, std::size_t given, LensFit& fit) {
  const LensBundle& bundle = pictures.bundle;
  const std::vector<double> p = as(LensModel::opencv5, bundle.lens).intrinsics;
  fit.lens = {.width_px = bundle.lens.image_size.width,
              .height_px = bundle.lens.image_size.height,
              .fx_px = p[0],
              .fy_px = p[1],
              .cx_px = p[2],
              .cy_px = p[3],
              .distortion = {p[4], p[5], p[6], p[7], p[8]}};
  fit.rms_px = uncertainty.rms_px;
  fit.covariance = Eigen::MatrixXd::Zero(9, 9);
  const int free = number_of_intrinsics(bundle.lens.model);
  fit.covariance.topLeftCorner(free, free) = uncertainty.covariance.topLeftCorner(free, free);
  fit.lattice = bundle.lattice;
  fit.board_warp_mm = bundle.warp_mm;
  fit.board_warp_sigma_mm = uncertainty.covariance.diagonal().tail<2>().cwiseSqrt();
  fit.picture_rms_px.assign(given, 0.0);
  fit.camera_from_lattice.assign(given, std::nullopt);
  for (std::size_t v = 0; v < bundle.pictures.size(); ++v) {
    const BundlePicture& picture = bundle.pictures[v];
    double squares = 0.0;
    int used = 0;
    for (std::size_t c = 0; c < picture.corners.size(); ++c) {
      fit.corner_errors.push_back({.picture = static_cast<int>(pictures.index[v]),
                                   .corner = picture.corners[c],
                                   .error_px = uncertainty.errors_px[v][c],
                                   .used = picture.used[c]});
      squares += uncertainty.errors_px[v][c].squaredNorm();
      used += picture.used[c] ? 1 : 0;
    }
    fit.picture_rms_px[pictures.index[v]] = used > 0 ? std::sqrt(squares / (2.0 * used)) : 0.0;
    fit.camera_from_lattice[pictures.index[v]] = picture.camera_from_lattice;
    fit.corners_used += used;
    fit.corners_rejected += static_cast<int>(picture.corners.size()) - used;
  }
  fit.converged = converged(uncertainty);
  const std::vector<double> sigmas =
      fit.converged ? sigmas_over_picture(bundle, uncertainty, fit.working_distance_mm)
                    : std::vector<double>(kGridRows * kGridColumns, std::numeric_limits<double>::infinity());
  using Map = Eigen::Matrix<double, kGridRows, kGridColumns, Eigen::RowMajor>;
  fit.projection_sigma_px = Eigen::Map<const Map>(sigmas.data());
}

void judge(const LensBundle& bundle, double focal_guess_px, const LensOptions& options, LensFit& fit) {
  const auto add = [&](const Gate& gate) { fit.gates.push_back(gate); };
  const double corners = fit.corners_used + fit.corners_rejected;
  add(at_most("rms of the corners used, px", fit.rms_px, 0.5,
              "corners are found to 0.1-0.2 px; blurred pictures, or a board that is not the one of the file"));
  add(at_most("corners rejected, %", 100.0 * fit.corners_rejected / corners, 5.0,
              "more are no accidents; look for pictures that moved and for tags that are covered or reflect"));
  const double guess_ratio = std::max(fit.lens.fx_px / focal_guess_px, focal_guess_px / fit.lens.fx_px);
  add(at_most("focal length over its guess, or the inverse", guess_ratio, 2.0,
              "another lens, zoom or picture size than the guess is for"));
  add(at_most("fx / fy - 1", std::abs(fit.lens.fx_px / fit.lens.fy_px - 1.0), 0.02,
              "sensors have square pixels; the picture was stretched, or the pictures are too few or alike"));
  add(at_most("uncertainty of projections at the working distance, inner picture, px", middle_sigma_px(fit), 0.3,
              "take more pictures, with more tilt and up to the picture's edges"));
  if (fit.halves)
    add(at_most("half of the pictures against the other half, median px", fit.halves->median_px, 0.3,
                "the two halves saw different lenses: focus, zoom or stabiliser moved between pictures"));
  if (fit.focal_change_percent)
    add(at_most("focal length of half of the pictures against the other half, beyond its uncertainty, %",
                *fit.focal_change_percent, 0.5,
                "two cameras' pictures in one folder, or focus or zoom moved between pictures: sort them"));
  add(at_most("richer lens model (OPENCV8) against this one, median px", fit.opencv8.median_px, 0.3,
              "the lens bends in a way that five coefficients do not describe"));
  if (options.taped_distance_mm > 0.0) {
    const double ratio = median_distance_mm(bundle) / options.taped_distance_mm;
    add(at_most("board's distance over the tape measure, or the inverse", std::max(ratio, 1.0 / ratio), 1.5,
                "sizes in the board file are not those of the print (mm?), or the tape measure is wrong"));
  }
}

}  // namespace

double middle_sigma_px(const LensFit& fit) {
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < kGridRows * kGridColumns; ++i) {
    if (!is_inner(i)) continue;
    const auto row = static_cast<Eigen::Index>(i) / kGridColumns, column = static_cast<Eigen::Index>(i) % kGridColumns;
    squares += std::pow(fit.projection_sigma_px(row, column), 2);
    count += 1.0;
  }
  return std::sqrt(squares / count);
}

bool is_well_known(const LensFit& fit) {
  return fit.converged && all_passed(fit.gates) && middle_sigma_px(fit) <= kWellKnown_px;
}

double guess_focal_px(const std::vector<BoardPicture>& pictures, const Lattice& board, cv::Size image_size) {
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const BoardPicture& picture : pictures) {
    if (picture.size() < kFewestCornersPerPicture) continue;
    points.emplace_back();
    pixels.emplace_back();
    for (const LatticeCorner& corner : picture) {
      const Eigen::Vector3f point = board.point(corner.column, corner.row).cast<float>();
      points.back().emplace_back(point.x(), point.y(), point.z());
      pixels.back().emplace_back(static_cast<float>(corner.pixel.x()), static_cast<float>(corner.pixel.y()));
    }
  }
  const double width = std::max(image_size.width, image_size.height);
  if (points.empty()) return width;
  const cv::Mat1d matrix = cv::initCameraMatrix2D(points, pixels, image_size, 1.0);
  return matrix(0, 0) > 0.2 * width && matrix(0, 0) < 100.0 * width ? matrix(0, 0) : width;
}

LensFit fit_lens(const std::vector<BoardPicture>& pictures, const Lattice& board, cv::Size image_size,
                 double focal_guess_px, const LensOptions& options) {
  UsedPictures gathered = gather(pictures, board, image_size, focal_guess_px);
  LensFit fit;
  fit.gates = require_determined(gathered);
  LensBundle& bundle = gathered.bundle;
  const BundleOutcome outcome = solve_in_stages(bundle);
  fit.messages = outcome.messages;
  if (!sane(bundle, outcome))
    refuse_lens("the fit went astray", "check the board's sizes and ids, and take pictures with more tags in them");
  fit.working_distance_mm =
      options.working_distance_mm > 0.0 ? options.working_distance_mm : median_distance_mm(bundle);
  BundleUncertainty uncertainty;
  let_go_of_regularisation(bundle, uncertainty, fit);
  compare_with_opencv8(bundle, fit);
  compare_halves(bundle, fit);
  report(gathered, uncertainty, pictures.size(), fit);
  judge(bundle, focal_guess_px, options, fit);
  return fit;
}

LensFit fit_lens(const std::vector<TagObservation>& pictures, const TagLayout& board, cv::Size image_size,
                 double focal_guess_px, const LensOptions& options) {
  const TagLattice tags = lattice_of(board);
  std::vector<BoardPicture> corners;
  for (const TagObservation& picture : pictures) corners.push_back(on_lattice(tags, board, picture));
  const std::string displaced = displaced_tags(tags, board, corners);
  if (!displaced.empty())
    refuse_lens(displaced + " do not lie where the board file says in most pictures",
                "check whether two tags are exchanged, and that the board file is the one of this print");
  return fit_lens(corners, tags.lattice, image_size, focal_guess_px, options);
}

}  // namespace calibration
