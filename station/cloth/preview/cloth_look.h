// A look at cloth that gets better while one looks: a coarse picture at once, then finer ones, begun anew whenever
// somebody turns the view or the light.
//
// What is asked comes in lines on standard input, {"look": 7, "turn_deg": ..., ...} (cloth_stage.h); after its end the
// look ends with the best picture. Ctrl-C ends it at once, and so does an hour without a line. What is shown is a file
// that is always whole, with a line on standard output each time that it is another: {"shown": {"look": 7, "picture":
// 31, "samples": 16, "of": 128}}, where "look" is that of the last line (0: none came yet) and "samples" counts per
// pixel of the full size (0: coarser).
#pragma once

#include <filesystem>
#include <string>

#include "station/cloth/preview/woven_threads.h"
#include "station/output/progress.h"

namespace station {

inline constexpr const char* kLookPicture = "look.png";  // in the cloth's folder

struct ClothLookRequest {
  ThreadsToWeave cloth;
  std::string shape = "swatch";  // cloth_shapes()
  int input = 0;                 // file descriptor of the lines
  int samples_per_pixel = 128;   // when it is done with a view
  int size_px = 0;               // the longer side of the picture; 0: as a screen shows it
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Errors: those of weave_threads; std::runtime_error, one line, for a shape that there is not, and for a line that asks
// for no view.
void look_at_cloth(const ClothLookRequest& request);

}  // namespace station
