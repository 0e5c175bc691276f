// The evidence for the thread model as pictures, simulated and fitted anew (Xia et al. 2025, figures 3, 4 and 5): the
// work behind `threadstation scatter plot`.
#pragma once

#include <filesystem>
#include <vector>

#include "renderer/scattering/multi_fiber.h"
#include "station/progress.h"

namespace station {

struct ScatterPlotRequest {
  std::filesystem::path out;            // a folder, made where missing
  renderer::MultiFiberOptions options;  // of the thread; theta and absorption are varied
  ProgressStyle progress = ProgressStyle::automatic;
};

// Writes figure_3, figure_4 and figure_5, each as .svg and .png, and fits.json with the figures behind them; returns the
// files. Figure 3: one configuration; one circle against many, for several fiber radii. Figure 4: lobes of one circle;
// scale factors against cos theta. Figure 5: simulated and fitted distributions, thread and yarn model, each
// inclination by itself and jointly. Errors: std::runtime_error with one line.
std::vector<std::filesystem::path> plot_scattering(const ScatterPlotRequest& request);

}  // namespace station
