// Synthetic validation of fits [Xia 2025, figure 9]: spools of threads made of fibers are photographed by path tracing,
// fitted with the thread model and both baselines, and predicted at views that the fits have not seen.
//
//   spool          | the fibers of a spool file, in 17 ideal views of 256 x 192 pixels (synthetic_views.h)
//   photograph     | two of each view with paths of their own and a 14-bit sensor's noise; fits see their mean
//   left out       | two views a fold, one reflection and one transmission; three folds
//   another draw   | a second spool of the same thread, its fibers placed anew: no fit of the thread can know them
//   solvers        | optional: Levenberg-Marquardt and Adam on all views, compared by eq. 6's loss on other paths and
//                  | by time; also the fewest of Levenberg-Marquardt's first rounds that get as far as Adam
//   agreement      | relative RMSE over 8 x 8-block averages without the noise of either side
//                  | (inversion/view/agreement.h)
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "inversion/fit/fit_views.h"
#include "inversion/fit/independent_loss.h"
#include "station/output/progress.h"

namespace station {

struct ValidateRequest {
  std::filesystem::path rig, out;
  std::vector<std::filesystem::path> spools;
  std::vector<inversion::ModelKind> models{inversion::ModelKind::thread, inversion::ModelKind::fiber,
                                           inversion::ModelKind::yarn};
  int folds = 3;         // 0 ... 3
  bool solvers = false;  // compare the solvers on each spool
  // A calibration of the rig (folder or file): when given, the thread model is also fitted with its camera, axis and
  // lamps.
  std::optional<std::filesystem::path> calibration;
  int samples_per_pixel = 96;  // in each photograph
  int fitted_samples = 48;     // in each rendering of a fitted view
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct ValidatedModel {
  inversion::ModelKind model;
  bool calibrated = false;  // fitted with a calibration's geometry and light, not the true ones
  // Relative RMSE over the left-out views: all of them, reflections, transmissions.
  double relative_rmse = 0, reflection = 0, transmission = 0;
  double fitted_views = 0;  // relative RMSE over the fitted views of the first fold
  double seconds = 0;       // time of one fit, mean over the folds
  struct OfView {
    std::string id;
    bool left_out;
    double relative_rmse, relative_bias;
  };
  std::vector<OfView> views;  // those of the first fold
};

struct ComparedSolver {
  std::string name;
  double seconds = 0;
  inversion::IndependentLoss loss;
};

struct ValidatedSpool {
  std::string name;
  int fibers_per_thread = 0;
  // How far one draw of the fibers is from the mean of all: relative RMSE between two draws, over the root of 2; over
  // all views, reflections, transmissions.
  double draw = 0, draw_reflection = 0, draw_transmission = 0;
  std::vector<ValidatedModel> models;
  std::vector<ComparedSolver> solvers;  // empty when not asked for
};

// Runs the validation. Photographs are kept in OUT/<spool>/photographs and used again when nothing that they depend on
// has changed; pictures of the left-out views (photograph, models, differences) are written beside them, and
// validation.json after every spool. Ctrl-C stops it. Errors: std::runtime_error for files and for spools without
// simulated fibers.
std::vector<ValidatedSpool> validate_fits(const ValidateRequest& request);

std::string describe(const std::vector<ValidatedSpool>& spools);
nlohmann::json to_json(const std::vector<ValidatedSpool>& spools);

}  // namespace station
