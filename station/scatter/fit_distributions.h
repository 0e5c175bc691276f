// Fits of simulated distributions, each by itself and jointly: the work behind `threadstation scatter fit`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "renderer/scattering/azimuthal_fit.h"
#include "station/progress.h"
#include "station/scatter/distribution_file.h"

namespace station {

// Of one distribution, each model by itself.
struct SeparateFits {
  renderer::SeparateThreadFit thread;
  renderer::YarnFit yarn;
  renderer::AzimuthalFit forward_and_uniform;
};

// Of several distributions at once.
struct JointFits {
  std::vector<std::size_t> members;  // of the distributions
  renderer::JointThreadFit thread;
  renderer::YarnFit yarn;
};

struct DistributionFits {
  std::vector<Distribution> distributions;
  std::vector<SeparateFits> separate;
  std::vector<JointFits> by_absorption;  // over inclinations, for each absorption with two or more of them
  std::vector<JointFits> over_all;       // one over absorptions too, when there are several
};

// Progress per fit; ctrl-C between fits stops.
DistributionFits fit_distributions(std::vector<Distribution> distributions, ProgressStyle progress);

struct FitRequest {
  std::vector<std::filesystem::path> in;
  std::filesystem::path out;
  ProgressStyle progress = ProgressStyle::automatic;
};

// Reads, fits, writes the JSON document. Errors: those of distribution_file.h; distributions of different threads.
DistributionFits fit_files(const FitRequest& request);

nlohmann::json to_json(const DistributionFits& fits);
std::string error_table(const DistributionFits& fits);  // relative L2 errors in percent, model beside model

}  // namespace station
