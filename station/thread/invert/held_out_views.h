// The views that a fit leaves out, so that it can be told how well it predicts what it has not seen.
#pragma once

#include <vector>

#include "station/documents/views_file.h"

namespace station {

// Which of the views are left out when `count` are: the same share of reflections and transmissions, and of the
// mountings of the holder, as nearly as there can be. They are spread evenly over the platform's angles, and each has
// fitted ones on both sides, so of n views of one light and mounting at most (n - 1) / 2 are left out. Errors:
// std::runtime_error when more are asked for.
std::vector<bool> held_out_views(const std::vector<DevelopedView>& views, int count);

}  // namespace station
