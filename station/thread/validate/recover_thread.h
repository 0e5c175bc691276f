// Recovery of a known thread: its pictures, rendered by its own model in the 17 ideal views (synthetic_views.h), are
// fitted. This tells how far the fit is from the truth, and whether its predicted deviations are the spread of fits to
// other draws of the noise.
//
//   photograph     | path-traced once; each draw adds the noise of a 14-bit sensor anew
//   first fit      | starts cold with all defaults, so its errors are those of a digitized thread
//   further fits   | start from the first one's thread: the last two rounds only, with light paths of their own
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "inversion/fit/fit_views.h"
#include "inversion/fit/independent_loss.h"
#include "station/output/progress.h"

namespace station {

struct RecoverRequest {
  std::filesystem::path rig, spool, thread;  // only the wrapping of the spool is used, not its fibers
  int draws = 50;                            // draws of the noise; 0 or at least 2
  int samples_per_pixel = 512;
  inversion::FitOptions fit{};
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct RecoveredQuantity {
  std::string name;  // "sigma_a[0]" "alpha[0]" "beta[0]" "lambda_0(0.7)"
  double truth = 0;
  double fitted = 0, sigma = 0;  // the first fit's value and its total predicted deviation
  double mean = 0, spread = 0,
         predicted = 0;  // over the draws: deviation seen, and predicted from noise; 0 without draws
  double held = 0;       // share of the draws within three of their own total deviations of the truth
};

struct RecoveredThread {
  std::string thread;
  double seconds = 0;  // time of the first fit
  // The sum of eq. 6 [Xia 2025] on light paths that no fit has seen. A fit that is worse than the truth has not
  // converged; one that is clearly better has learnt something that is not in the thread.
  inversion::IndependentLoss loss_of_truth, loss_of_fit;
  int draws = 0;
  std::vector<RecoveredQuantity> quantities;
};

// Photographs and fits. Ctrl-C stops it. Errors: std::runtime_error for files, for a rig without simulation, and when
// it is stopped.
RecoveredThread recover_thread(const RecoverRequest& request);

// One thread after the other; calls found() with each.
std::vector<RecoveredThread> recover_threads(RecoverRequest request, const std::vector<std::filesystem::path>& threads,
                                             const std::function<void(const RecoveredThread&)>& found);

std::string describe(const RecoveredThread& recovered);
// A line for each thread: how its draws held, and how well their spread was predicted. Empty for one thread, or for
// less than two draws.
std::string table_of(const std::vector<RecoveredThread>& recovered);
nlohmann::json to_json(const RecoveredThread& recovered);
nlohmann::json to_json(const std::vector<RecoveredThread>& recovered);  // of one: that one

}  // namespace station
