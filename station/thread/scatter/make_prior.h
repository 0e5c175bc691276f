// The making of the built-in prior of thread parameters from simulations: the work behind `threadstation scatter
// prior`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "renderer/scattering/thread_prior.h"
#include "station/output/progress.h"

namespace station {

// options.progress is replaced. Simulates and fits the first `threads` of the library, writes mean, covariance and
// every thread with its fit, and returns the document. Ctrl-C stops it between threads.
nlohmann::json make_prior(const std::filesystem::path& out, renderer::PriorOptions options, std::size_t threads,
                          ProgressStyle progress);

}  // namespace station
