// The prediction of a photographed cloth from the threads and the draft that it is said to be woven of, view by view,
// and how far the photographs are from it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "renderer/weave/draft.h"
#include "station/cloth/fabric_measures.h"
#include "station/output/compare/compare_pictures.h"
#include "station/output/progress.h"

namespace station {

struct PredictRequest {
  std::filesystem::path session;   // a developed session of a cloth on the cylinder
  std::filesystem::path fabric{};  // fabric file of the weave; empty: the session's own
  // What its warp and weft are digitized as, both or neither: sessions with a fitted `model`, or model files. Empty:
  // the weave's own threads, which are a thread model's.
  std::filesystem::path warp{}, weft{};
  std::string model = "thread";  // or "bundle", "fiber", "yarn": of the sessions
  int samples_per_pixel = 64;
  std::uint64_t seed = 1;
  bool fit_scale = false;  // compare after a scale that makes it as bright as its photograph
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct PredictedView {
  std::string view;
  std::filesystem::path prediction;  // EXR: linear camera RGB, radiance unit; 0 outside the mask
  std::filesystem::path beside;      // PNG: photograph, prediction, difference
  int block_px = 0;                  // size of the averages compared: two repeats of the weave or more
  Comparison comparison;
};

nlohmann::json to_json(const PredictedView& view);

// Predicts all views and writes result/fabric/<view>.exr and .png, by another model than a thread's in
// result/fabric/<model>. Errors: std::runtime_error for a session of a wrapped thread, one that is not developed, a
// fabric without a weave, threads that are not fitted so, or another model than a thread's without warp and weft.
std::vector<PredictedView> predict_fabric(const PredictRequest& request);

// The sett of a photographed cloth by its repeat, beside that of the weave that it is said to have.
struct MeasuredSett {
  ClothPeriods periods;
  double said_around_mm = 0, said_along_mm = 0;  // the repeat of the patch
  int ends = 0, picks = 0;                       // in a repeat
  renderer::Draft draft;                         // of the weave, with the measured pitches as far as they are known
};
// `fabric` as in PredictRequest. Errors: those of predict_fabric.
MeasuredSett measure_sett(const std::filesystem::path& session, const std::filesystem::path& fabric,
                          ProgressStyle progress_style);
std::string describe(const MeasuredSett& sett);
nlohmann::json to_json(const MeasuredSett& sett);

}  // namespace station
