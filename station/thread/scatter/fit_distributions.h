// Fits of thread and yarn models to simulated distributions, each by itself and jointly: the work behind `threadstation
// scatter fit`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "renderer/scattering/azimuthal_fit.h"
#include "station/output/progress.h"
#include "station/thread/scatter/distribution_file.h"

namespace station {

// The fits to one distribution, each model by itself.
struct SeparateFits {
  renderer::SeparateThreadFit thread;
  renderer::YarnFit yarn;
  renderer::AzimuthalFit forward_and_uniform;
};

// The fits to several distributions at once.
struct JointFits {
  std::vector<std::size_t> members;  // indices of the distributions
  renderer::JointThreadFit thread;
  renderer::YarnFit yarn;
};

struct DistributionFits {
  std::vector<Distribution> distributions;
  std::vector<SeparateFits> separate;
  std::vector<JointFits> by_absorption;  // over inclinations, per absorption with two or more
  std::vector<JointFits> over_all;       // one over absorptions too, if there are several
};

// Makes all fits and shows progress fit by fit; ctrl-C between two fits stops it.
DistributionFits fit_distributions(std::vector<Distribution> distributions, ProgressStyle progress);

struct FitRequest {
  std::vector<std::filesystem::path> in;
  std::filesystem::path out;
  ProgressStyle progress = ProgressStyle::automatic;
};

// Reads the files, fits, and writes the JSON document. Errors: those of distribution_file.h; std::runtime_error for
// distributions of different threads.
DistributionFits fit_files(const FitRequest& request);

nlohmann::json to_json(const DistributionFits& fits);
std::string error_table(const DistributionFits& fits);  // relative L2 errors in percent, model beside model

}  // namespace station
