// The whole job on the simulated bench: calibrate, capture, develop, report.
#pragma once

#include <filesystem>

#include "station/progress.h"

namespace station {

struct DemoRequest {
  std::filesystem::path out = "demo";
  bool quick = false;  // fewer samples per pixel: noisier pictures, same steps
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct DemoResult {
  std::filesystem::path session, report;
};

// Goes on where an earlier demo in the same folder was interrupted; a finished one is made again from the start.
DemoResult run_demo(const DemoRequest& request);

}  // namespace station
