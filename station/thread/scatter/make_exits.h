// The making of the built-in table of where light leaves threads from simulations: the work behind `threadstation
// scatter exits`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "renderer/scattering/exit_offsets.h"
#include "station/output/progress.h"

namespace station {

// options.progress is replaced. Simulates the library of threads, writes the table and returns it as a document. It
// has, for each bin of offset in and azimuth, a row of text: the shares of the offsets out in parts of 10,000. Ctrl-C
// stops it between simulations.
nlohmann::json make_exits(const std::filesystem::path& out, renderer::ExitOptions options, ProgressStyle progress);

}  // namespace station
