// The drawing of a stand that holds a calibration target on the platform, to be cut from a sheet by hand or by laser.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "station/bench/paper_page.h"
#include "station/documents/rig_file.h"

namespace station {

// A cheek of the stand (from 1) as seen from its left side: corners in mm, x forward from the stand's middle, y up from
// the platform. The plate's lower edge rests on the ledge, its back on the cheek; a lip of 2 mm keeps it there.
std::vector<Eigen::Vector2d> cheek_outline(const RigFile& rig, int stand);

// Both cheeks and both bars with their dimensions and a word on what to do, on a page of this size.
void draw_stand(cairo_t* pen, const RigFile& rig, int stand, Paper paper);

}  // namespace station
