// The prediction of a photographed cloth from the threads and the draft that it is said to be woven of, view by view,
// and how far the photographs are from it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "station/cloth/photographed_fabric.h"
#include "station/output/compare/compare_pictures.h"
#include "station/output/progress.h"

namespace station {

struct PredictRequest {
  SaidFabric cloth;
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
// result/fabric/<model>. Errors: those of woven_models.
std::vector<PredictedView> predict_fabric(const PredictRequest& request);

}  // namespace station
