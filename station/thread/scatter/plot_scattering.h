// Plots of the evidence for the thread model, simulated and fitted anew (Xia et al. 2025, figures 3, 4 and 5): the work
// behind `threadstation scatter plot`.
#pragma once

#include <filesystem>
#include <vector>

#include "renderer/scattering/multi_fiber.h"
#include "station/output/progress.h"

namespace station {

struct ScatterPlotRequest {
  std::filesystem::path out;            // a folder; made when missing
  renderer::MultiFiberOptions options;  // the thread's; theta and absorption are varied
  ProgressStyle progress = ProgressStyle::automatic;
};

// Writes figure_3, figure_4 and figure_5, each as .svg and .png, and fits.json with the numbers behind them; returns
// the files. Figure 3 compares one circle with many, for several fiber radii at one configuration. Figure 4 shows the
// lobes of one circle, and scale factors against cos theta. Figure 5 shows simulated and fitted distributions, by the
// thread and the yarn model, each inclination by itself and jointly. Errors: std::runtime_error with one line.
std::vector<std::filesystem::path> plot_scattering(const ScatterPlotRequest& request);

}  // namespace station
