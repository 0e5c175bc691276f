// What photographs of a cloth on the cylinder tell of its weave: sett and heights, for drafts of cloth whose making is
// not known.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "renderer/weave/draft.h"
#include "station/cloth/fabric_height.h"
#include "station/cloth/fabric_measures.h"
#include "station/cloth/photographed_fabric.h"
#include "station/output/progress.h"

namespace station {

// The sett of a photographed cloth by its repeat, beside that of the weave that it is said to have.
struct MeasuredSett {
  ClothPeriods periods;
  double said_around_mm = 0, said_along_mm = 0;  // the repeat of the patch
  int ends = 0, picks = 0;                       // in a repeat
  renderer::Draft draft;                         // of the weave, with the measured pitches as far as they are known
};
// Errors: those of woven_models.
MeasuredSett measure_sett(const SaidFabric& cloth, ProgressStyle progress_style);
std::string describe(const MeasuredSett& sett);
nlohmann::json to_json(const MeasuredSett& sett);

struct MeasureFabricRequest {
  SaidFabric cloth;
  bool sett = true, height = false;  // what is measured
  int samples_per_pixel = 16;        // of the predictions whose highlights are compared
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct MeasuredFabric {
  std::optional<MeasuredSett> sett;
  std::optional<MeasuredHeight> height;
  renderer::Draft draft;  // of the weave, with all that could be measured
};

// Errors: those of measure_sett and measure_height.
MeasuredFabric measure_fabric(const MeasureFabricRequest& request);
std::string describe(const MeasuredFabric& measured);
nlohmann::json to_json(const MeasuredFabric& measured);

}  // namespace station
