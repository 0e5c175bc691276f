#include "station/thread/scatter/make_prior.h"

#include <algorithm>
#include <cmath>

#include "station/documents/reader.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

using nlohmann::json;

// Rounds to digits that are enough for a prior, in a file that people can read.
double rounded(double value) {
  return std::round(value * 1e6) / 1e6;
}

json numbers(const renderer::PriorVector& v) {
  json list = json::array();
  for (double value : v) list.push_back(rounded(value));
  return list;
}

}  // namespace

json make_prior(const std::filesystem::path& out, renderer::PriorOptions options, std::size_t threads,
                ProgressStyle style) {
  watch_interrupts();
  ProgressDisplay display("prior", style);
  options.progress = [&](int done, int total) {
    display.show(done, total, "threads simulated and fitted");
    return !interrupted();
  };
  std::vector<renderer::LibraryThread> library_threads = renderer::thread_library();
  library_threads.resize(std::min(threads, library_threads.size()));
  const std::vector<renderer::LibraryFit> fits = renderer::fit_library(library_threads, options);
  const renderer::ThreadPrior prior = renderer::prior_of(fits);
  json covariance = json::array(), library = json::array();
  for (int i = 0; i < prior.covariance.rows(); ++i) covariance.push_back(numbers(prior.covariance.row(i).transpose()));
  for (const renderer::LibraryFit& fit : fits)
    library.push_back({{"radius_ratio", fit.thread.radius_ratio},
                       {"eta", fit.thread.eta},
                       {"gap_fiber_radii", fit.thread.gap},
                       {"absorptions_per_fiber_radius", fit.thread.absorptions},
                       {"relative_l2_error", rounded(fit.error)},
                       {"unknowns", numbers(fit.unknowns)},
                       {"deviations", numbers(fit.covariance.diagonal().cwiseSqrt())}});
  const json document{{"made_by", "threadstation scatter prior --seed " + std::to_string(options.seed) + " --threads " +
                                      std::to_string(library_threads.size()) + " --configurations " +
                                      std::to_string(options.configurations)},
                      {"unknowns", {"beta_R", "beta_TT", "beta_TRT", "L0", "L1", "concavity", "r1a", "d2", "w2", "n2"}},
                      {"threads", prior.threads},
                      {"mean", numbers(prior.mean)},
                      {"covariance", covariance},
                      {"library", library}};
  write_json_file(out, document);
  return document;
}

}  // namespace station
