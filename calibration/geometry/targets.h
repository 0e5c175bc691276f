// Layouts of the printed tags other than the board's: on the platform, on the table, at the corners of a face.
//
// Each layout is in the frame of the object that carries it (mm). A print is seldom to scale: a control bar printed
// beside the tags is measured, and `scaled` makes the layout of the print as it came out.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/geometry/tags.h"

namespace calibration {

inline constexpr double kControlBar_mm = 100.0;  // length of the control bar as drawn

// Four tags at (+-offset, +-offset) in the plane spanned by the unit vectors `right` and `up`, facing right x up; ids
// in the order top left, top right, bottom left, bottom right.
TagLayout make_corner_tags(const std::string& name, double tag_mm, double offset_mm, int first_id,
                           const Eigen::Vector3d& right, const Eigen::Vector3d& up);

// A ring of `count` tags lying flat: their centres at `radius_mm`, the first at +x, the others counter-clockwise seen
// from above, each upright for a viewer outside of the ring. Frame: origin at the ring's centre, +z up. Throws
// std::runtime_error when the tags with their white borders do not fit side by side.
TagLayout make_platform_ring(int count, double radius_mm, double tag_mm, int first_id);

// Tags lying flat with these centres, all upright for a viewer who looks along -x (the camera). Frame: +z up, nominally
// the world's; as a hand puts the sheet down, only the positions relative to each other are exact. Throws
// std::runtime_error when two tags would overlap.
TagLayout make_table_sheet(const std::vector<Eigen::Vector2d>& centres_mm, double tag_mm, int first_id);

// The layout with sizes and positions scaled to a print whose control bar came out `control_bar_mm` long.
TagLayout scaled(TagLayout layout, double control_bar_mm);

// A message like "tag 203 is on spectralon and on table" when two layouts share an id, empty otherwise. A picture
// cannot tell two tags with one id apart.
std::string shared_ids(const std::vector<TagLayout>& layouts);

}  // namespace calibration
