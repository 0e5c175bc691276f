// A developed session to a digitized thread: the fit, the views as the fitted thread gives them, and how well they
// agree; everything under result/ of the session.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "inversion/fit_views.h"
#include "station/invert/fit_document.h"
#include "station/progress.h"

namespace station {

struct InvertRequest {
  std::filesystem::path session;
  std::optional<std::filesystem::path> out;  // the model's file goes there as well
  inversion::FitOptions fit;                 // its progress is replaced
  int samples_per_pixel = 16;                // of the fitted views
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct InvertResult {
  renderer::ScatteringModel model;
  std::filesystem::path file;  // of the model: thread.json, fiber.json or yarn.json
  std::vector<FittedView> views{};
  nlohmann::json fit{};               // fit_document.h
  double relative_rmse = 0;           // overall (inversion/agreement.h)
  std::vector<std::string> doubts{};  // inversion/fit_doubts.h
};

// Writes result/thread.json, result/fitted/<view>.exr and result/residual/<view>.exr (fitted minus photographed; both
// linear camera RGB, radiance unit, zero outside the mask); of the baselines the same, with fit.json, in result/fiber/ and
// result/yarn/. Ctrl-C stops it; the model is written last, so that it always belongs to whole pictures. Errors: those of read_views and fit_views, and of what cannot be written.
InvertResult invert_session(const InvertRequest& request);

std::string describe(const InvertResult& result);
nlohmann::json to_json(const InvertResult& result);

// The fitted view and residual that invert_session left, for reports. Empty when there are none.
std::filesystem::path thread_file_of(const std::filesystem::path& session);
std::filesystem::path fitted_file_of(const std::filesystem::path& session, const std::string& view);

}  // namespace station
