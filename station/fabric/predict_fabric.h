// What a photographed cloth should look like by the threads and the draft it is said to be woven of, view by view, and how
// far the photographs are from it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "station/compare/compare_pictures.h"
#include "station/progress.h"

namespace station {

struct PredictRequest {
  std::filesystem::path session;   // of a cloth on the cylinder, developed
  std::filesystem::path fabric{};  // whose weave is predicted; empty: what the session says of its own
  int samples_per_pixel = 64;
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct PredictedView {
  std::string view;
  std::filesystem::path prediction;  // linear, radiance unit, as the photograph; 0 outside of the mask
  std::filesystem::path beside;      // PNG: photograph, prediction, difference
  int block_px = 0;                  // of the averages that are compared: two repeats of the weave or more
  Comparison comparison;
};

nlohmann::json to_json(const PredictedView& view);

// Writes result/fabric/<view>.exr and .png. Errors: std::runtime_error for a session of a wrapped thread, one that is not
// developed, a fabric without a weave.
std::vector<PredictedView> predict_fabric(const PredictRequest& request);

}  // namespace station
