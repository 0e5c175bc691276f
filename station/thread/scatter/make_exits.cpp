#include "station/thread/scatter/make_exits.h"

#include <cmath>
#include <numeric>

#include "station/documents/reader.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

constexpr double kParts = 10000;

}  // namespace

nlohmann::json make_exits(const std::filesystem::path& out, std::uint64_t seed, ProgressStyle style) {
  watch_interrupts();
  ProgressDisplay display("exits", style);
  renderer::ExitOptions options{.seed = seed};
  options.progress = [&](int done, int total) {
    display.show(done, total, "threads simulated");
    return !interrupted();
  };
  std::vector<double> exits = renderer::mean_exits(renderer::clear_threads(renderer::thread_library()), options);
  for (auto row = exits.begin(); row != exits.end(); row += options.offset_bins) {
    const double sum = std::accumulate(row, row + options.offset_bins, 0.0);
    for (auto share = row; share != row + options.offset_bins; ++share) *share = std::round(kParts * *share / sum);
  }
  const nlohmann::json document{{"made_by", "threadstation scatter exits --seed " + std::to_string(seed)},
                                {"offset_bins", options.offset_bins},
                                {"azimuth_bins", options.azimuth_bins},
                                {"share", std::vector<int>(exits.begin(), exits.end())}};
  write_json_file(out, document);
  return document;
}

}  // namespace station
