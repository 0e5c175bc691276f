// Recovery: pictures of a known thread, rendered by its own model at the 17 ideal views (synthetic_views.h), are fitted. How far
// is the fit from the truth, and are its predicted deviations the spread of fits to other draws of the noise?
//
//   photograph     | path-traced once; each draw adds the noise of a 14-bit sensor anew
//   first fit      | cold, all defaults: its errors are those of a digitized thread
//   further fits   | from the first one's thread, the last two rounds only, light paths of their own
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "inversion/fit_views.h"
#include "station/progress.h"

namespace station {

struct RecoverRequest {
  std::filesystem::path rig, spool, thread;  // of the spool its wrapping is taken, and no fibers
  int draws = 50;                            // of the noise; 0 or at least 2
  int samples_per_pixel = 512;
  inversion::FitOptions fit{};
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct RecoveredQuantity {
  std::string name;  // "sigma_a[0]" "alpha[0]" "beta[0]" "lambda_0(0.7)"
  double truth = 0;
  double fitted = 0, sigma = 0;  // the first fit's, with its total predicted deviation
  double mean = 0, spread = 0,
         predicted = 0;  // over the draws: deviation seen, and predicted from noise; 0 without draws
};

struct RecoveredThread {
  std::string thread;
  double seconds = 0;  // of the first fit
  // Eq. 6's sum on light paths that no fit has seen: a fit that is worse than the truth has not got there; one that is
  // clearly better has learnt something that is not in the thread.
  inversion::IndependentLoss loss_of_truth, loss_of_fit;
  int draws = 0;
  std::vector<RecoveredQuantity> quantities;
};

// Ctrl-C stops it. Errors: std::runtime_error of files, of rigs without simulation, when it is stopped.
RecoveredThread recover_thread(const RecoverRequest& request);

std::string describe(const RecoveredThread& recovered);
nlohmann::json to_json(const RecoveredThread& recovered);

}  // namespace station
