// AprilTag (tag36h11) layouts on printed objects, and their detection in pictures.
//
// Corner order everywhere: as seen from the front of the printed tag, starting bottom left, counter-clockwise
// (AprilTag's own order with +x right, +y up on the tag). Object frame: mm; the tag plane's normal is the tag's +z,
// towards the viewer. Pixel positions: centre of the first pixel at (0, 0).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace calibration {

struct Tag {
  int id = 0;
  double size_mm = 0.0;  // edge of the black square
  // Origin at the tag's centre; +x right, +y up, +z towards the viewer.
  Eigen::Isometry3d object_from_tag = Eigen::Isometry3d::Identity();
};

struct TagLayout {
  std::string name;
  std::vector<Tag> tags;
};

// A regular board of rows x columns tags with ids counted from first_id along rows from the top left. Frame: origin at
// the board's centre, +x right, +y up, +z towards the viewer.
TagLayout make_tag_board(const std::string& name, int rows, int columns, double tag_mm, double pitch_mm, int first_id);

std::array<Eigen::Vector3d, 4> corners_in_object(const Tag& tag);  // mm

struct TagDetection {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners_px;
};

using TagObservation = std::vector<TagDetection>;  // one picture's tags

// The tags in `grey` (linear, any scale, non-negative), sorted by id; empty when there are none or the picture is
// empty. An id that is seen twice is ambiguous and dropped, and so is a tag that the picture's edge cuts. Corners of
// tags of 35-110 px are good to about 0.05 px per axis. Method: AprilTag 3.3, then calibration/geometry/tag_corners.h.
TagObservation detect_tags(const cv::Mat1f& grey);
// The same, and the ids that were dropped because they are seen twice.
struct TagsSeen {
  TagObservation tags;
  std::vector<int> repeated;
};
TagsSeen see_tags(const cv::Mat1f& grey);

// How many of the layout's tags are in the picture.
long tags_seen(const TagLayout& layout, const TagObservation& seen);

// The printed bitmap of a tag: 10 x 10 cells (black square of 8 x 8 cells inside a white border), 0 or 255, top row
// first as seen. Throws std::runtime_error for an id that the family does not have.
cv::Mat1b tag_bitmap(int id);

}  // namespace calibration
