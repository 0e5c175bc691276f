#include "station/thread/scatter/make_exits.h"

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "station/documents/reader.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

constexpr double kParts = 10000;

}  // namespace

nlohmann::json make_exits(const std::filesystem::path& out, renderer::ExitOptions options, ProgressStyle style) {
  watch_interrupts();
  ProgressDisplay display("exits", style);
  options.progress = [&](int done, int total) {
    display.show(done, total, "threads simulated");
    return !interrupted();
  };
  const std::vector<double> exits = renderer::mean_exits(renderer::clear_threads(renderer::thread_library()), options);
  nlohmann::json rows = nlohmann::json::array();
  for (auto row = exits.begin(); row != exits.end(); row += options.offset_bins) {
    const double sum = std::accumulate(row, row + options.offset_bins, 0.0);
    std::string text;
    for (auto share = row; share != row + options.offset_bins; ++share)
      text += (text.empty() ? "" : " ") + std::to_string(std::lround(kParts * *share / sum));
    rows.push_back(text);
  }
  const nlohmann::json document{{"made_by", "threadstation scatter exits --seed " + std::to_string(options.seed) +
                                                " --configurations " + std::to_string(options.configurations)},
                                {"offset_bins", options.offset_bins},
                                {"azimuth_bins", options.azimuth_bins},
                                {"rows", rows}};
  write_json_file(out, document);
  return document;
}

}  // namespace station
