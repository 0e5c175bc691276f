// Synthetic truth for the calibration tests: lenses, boards and poses, corners with known noise, and pictures of
// printed tags.
//
// Poses are camera_from_object (OpenCV camera axes, mm); pixels as in calibration/geometry/tags.h.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "calibration/geometry/board_plan.h"
#include "calibration/geometry/lattice.h"
#include "calibration/geometry/lens.h"
#include "calibration/geometry/tags.h"

namespace calibration::synthetic {

// The lens of the set-up that the tests stand for: 600 x 400 px, f about 2400 px, mild barrel distortion.
Lens narrow_lens();

// A board of 3 x 4 tags of 20 mm, pitch 30 mm.
TagLayout board();

Eigen::Vector2d project(const Lens& lens, const Eigen::Vector3d& point_in_camera);

// The pose camera_from_object of an object whose front faces the camera at `distance_mm`, turned by `yaw_rad` about its
// own +y, `pitch_rad` about its +x and `roll_rad` about its +z, its centre seen `shift_mm` beside the optical axis.
Eigen::Isometry3d facing(double distance_mm, double yaw_rad, double pitch_rad, double roll_rad,
                         const Eigen::Vector2d& shift_mm = Eigen::Vector2d::Zero());

// Observes the tags that lie wholly in the picture, each corner with Gaussian noise of `sigma_px` per axis.
TagObservation observe(const Lens& lens, const TagLayout& layout, const Eigen::Isometry3d& camera_from_object,
                       double sigma_px, std::mt19937& random);

// Observes, without noise, the corners of a bent lattice that lie in the picture. `bow_mm`: how far its middle stands
// out along columns and along rows.
BoardPicture observe_lattice(const Lens& lens, const Lattice& lattice, const Eigen::Vector2d& bow_mm,
                             const Eigen::Isometry3d& camera_from_lattice);

// Poses of a board held by hand: distances 450-750 mm, tilts to +-40 degrees, all over the picture.
std::vector<Eigen::Isometry3d> handheld_poses(int count, std::mt19937& random);

// Where a hand puts down a stand on the platform: within 30 mm each way and 15 degrees of where it should stand.
Eigen::Isometry3d put_down(const Eigen::Isometry3d& platform_from_object, std::mt19937& random);

// The poses camera_from_board of a board on a plate `plate_mm` wide and high as the guided calibration takes them: on
// the first `stands` of four, on every second of them on its side, put down by a hand and turned by the platform,
// `pictures` on each stand, under a camera that is known as `camera` says.
std::vector<Eigen::Isometry3d> stand_poses(const RoughCamera& camera, const TagLayout& board,
                                           const Eigen::Vector2d& plate_mm, int pictures, std::mt19937& random,
                                           std::size_t stands);

// A linear picture of the printed layout (paper 0.8, ink 0.04, surround 0.1), with `samples` x `samples` rays per
// pixel.
cv::Mat1f picture(const Lens& lens, const TagLayout& layout, const Eigen::Isometry3d& camera_from_object,
                  int samples = 6);

}  // namespace calibration::synthetic
