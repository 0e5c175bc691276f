// The inversion of a developed session to a digitized thread: the fit, the views as the fitted thread shows them, and
// how well they agree with the photographs; all results are under result/ of the session.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "inversion/fit/fit_views.h"
#include "station/output/progress.h"
#include "station/thread/invert/fit_document.h"

namespace station {

struct InvertRequest {
  std::filesystem::path session;
  std::optional<std::filesystem::path> out;  // a second place for the model's file
  inversion::FitOptions fit;                 // its progress function is replaced
  int held_out = 0;                          // number of views that the fit does not see (held_out_views.h)
  int samples_per_pixel = 16;                // in renderings of the views
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct InvertResult {
  renderer::ScatteringModel model;
  std::filesystem::path file;  // the model's: thread.json, fiber.json, yarn.json or paper.json
  std::vector<FittedView> views{};
  nlohmann::json fit{};               // the report of fit_document.h
  double relative_rmse = 0;           // over the fitted views (inversion/view/agreement.h)
  std::vector<std::string> doubts{};  // those of inversion/fit/fit_doubts.h, a sentence each
};

// Fits a session. Written are result/thread.json, result/fitted/<view>.exr and result/residual/<view>.exr (fitted minus
// photographed; both linear camera RGB, radiance unit, zero outside the mask); for a baseline the same with fit.json,
// in result/fiber/ or result/yarn/, and in result/paper/ for the paper's recipe. Views that are held out are drawn and
// compared like the others. Ctrl-C stops it; the model is written last, so that it always belongs to whole pictures.
// Errors: those of read_views, held_out_views and fit_views; std::runtime_error for what cannot be written.
InvertResult invert_session(const InvertRequest& request);

std::string describe(const InvertResult& result);
nlohmann::json to_json(const InvertResult& result);

}  // namespace station
