// The built-in prior of thread parameters, made again from simulations: the work behind `threadstation scatter prior`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "renderer/scattering/thread_prior.h"
#include "station/progress.h"

namespace station {

// Writes mean, covariance and every thread of the library with its fit. Ctrl-C stops between threads.
nlohmann::json make_prior(const std::filesystem::path& out, std::uint64_t seed, ProgressStyle progress);

}  // namespace station
