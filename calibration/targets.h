// Layouts of the printed tags besides the board: on the platform, on the table, on the lamp holder, around a face.
//
// Each in the frame of what carries it (mm). A print is seldom to scale: a control bar printed beside the tags is
// measured, and `scaled` makes the layout of the print as it came out.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/tags.h"

namespace calibration {

inline constexpr double kControlBar_mm = 100.0;  // as drawn

// Four tags at (+-offset, +-offset) of the plane spanned by the unit vectors `right` and `up`, facing right x up; ids
// in the order top left, top right, bottom left, bottom right.
TagLayout make_corner_tags(const std::string& name, double tag_mm, double offset_mm, int first_id,
                           const Eigen::Vector3d& right, const Eigen::Vector3d& up);

// A ring lying flat: `count` tags with their centres at `radius_mm`, the first at +x, counter-clockwise seen from above;
// each upright for who looks from outside. Frame: origin at the ring's centre, +z up. Throws std::runtime_error when
// the tags with their white borders do not fit side by side.
TagLayout make_platform_ring(int count, double radius_mm, double tag_mm, int first_id);

// Tags lying flat with these centres, all upright for who looks along -x (the camera). Frame: +z up; nominally the
// world, but a hand puts the sheet down: relative positions are good, the sheet's place is not. Throws
// std::runtime_error when two of them would overlap.
TagLayout make_table_sheet(const std::vector<Eigen::Vector2d>& centres_mm, double tag_mm, int first_id);

// The same print when `kControlBar_mm` came out as `control_bar_mm`: sizes and positions.
TagLayout scaled(TagLayout layout, double control_bar_mm);

// "tag 203 is on spectralon and on table", or empty when every id is used once. A picture cannot tell two tags with
// one id apart.
std::string shared_ids(const std::vector<TagLayout>& layouts);

}  // namespace calibration
