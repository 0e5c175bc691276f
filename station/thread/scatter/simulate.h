// A multi-fiber simulation whose result goes into a file: the work behind `threadstation scatter simulate`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "renderer/scattering/multi_fiber.h"
#include "station/output/progress.h"

namespace station {

struct SimulateRequest {
  renderer::MultiFiberOptions options;
  std::filesystem::path out;
  ProgressStyle progress = ProgressStyle::automatic;
};

// Simulates with progress (ctrl-C stops it) and writes the CSV of distribution_file.h. Errors: std::runtime_error or
// std::invalid_argument with one line.
renderer::MultiFiberScattering simulate_to_file(const SimulateRequest& request);

// Simulates with progress, without a file; errors as above.
renderer::MultiFiberScattering simulate_with_progress(renderer::MultiFiberOptions options, const std::string& task,
                                                      ProgressStyle style);

nlohmann::json to_json(const renderer::MultiFiberScattering& scattering);
std::string described(const renderer::MultiFiberScattering& scattering);

}  // namespace station
