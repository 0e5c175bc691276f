#include "station/thread/scatter/simulate.h"

#include <cstdio>

#include "station/documents/reader.h"
#include "station/output/interrupt.h"
#include "station/thread/scatter/distribution_file.h"

namespace station {

renderer::MultiFiberScattering simulate_with_progress(renderer::MultiFiberOptions options, const std::string& task,
                                                      ProgressStyle style) {
  constexpr int kSteps = 20;
  watch_interrupts();
  ProgressDisplay progress(task, style);
  int shown = 0;
  options.progress = [&](double fraction) {
    const int step = static_cast<int>(kSteps * fraction);
    if (step != shown) progress.show(100 / kSteps * step, 100, "%");
    shown = step;
    return !interrupted();
  };
  return renderer::simulate_multi_fiber(options);
}

renderer::MultiFiberScattering simulate_to_file(const SimulateRequest& request) {
  const renderer::MultiFiberScattering found = simulate_with_progress(request.options, "simulate", request.progress);
  write_text_file(request.out, distribution_text(request.options, found));
  return found;
}

nlohmann::json to_json(const renderer::MultiFiberScattering& s) {
  return {{"rays", s.rays},
          {"missed", s.miss},
          {"albedo", s.albedo},
          {"back", s.back},
          {"mean_fibers", s.mean_fibers},
          {"mean_fibers_entered", s.mean_entered},
          {"mean_length_fiber_radii", s.mean_length},
          {"energy_by_refractions", s.by_fibers_passed}};
}

std::string described(const renderer::MultiFiberScattering& s) {
  char text[512];
  std::snprintf(text, sizeof text,
                "%.4g million rays met a fiber, %.2f %% missed; %.1f fibers, %.2f entered per ray\n"
                "albedo %.4f, back fraction %.4f, way inside fibers %.2f fiber radii\n",
                static_cast<double>(s.rays) * 1e-6, 100 * s.miss, s.mean_fibers, s.mean_entered, s.albedo, s.back,
                s.mean_length);
  return text;
}

}  // namespace station
