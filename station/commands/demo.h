// The demo: the whole job on the simulated bench, from calibration and capture to development, inversion, weaving,
// rendering and report.
#pragma once

#include <filesystem>
#include <vector>

#include "station/output/progress.h"

namespace station {

struct DemoRequest {
  std::filesystem::path out = "demo";
  bool quick = false;  // fewer samples per pixel: noisier pictures, same steps
  bool fresh = false;  // make everything again instead of keeping what is there
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct DemoResult {
  std::filesystem::path session, thread;
  double relative_rmse = 0;  // the fitted thread's
  std::vector<std::filesystem::path> cloth;
  std::filesystem::path report;
  bool kept = false;  // pictures of an earlier demo on the same rig were kept
};

// Runs the demo. What an earlier demo on the same rig left whole in the folder is kept: an interrupted one goes on, a
// finished one is only reported again. Another rig (or --quick against full) starts from the
// beginning.
DemoResult run_demo(const DemoRequest& request);

}  // namespace station
