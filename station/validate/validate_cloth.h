// Prediction of woven samples from threads digitized on spools [Xia 2025, section 6, figures 10 and 11], on synthetic ones, where
// the truth is known.
//
//   spool     | simulated fibers, photographed in 17 views and fitted with the thread model and both baselines
//   sample    | each weave in each warp colour, all with the same weft, on the black cylinder, lit from the right and the left
//   reference | the same cloth, every yarn the fibers of its spool: a patch of fibers in two scales
//   table     | CIEDE2000 of block averages, and place, width, height and hue of the highlight, in one unit of radiance: nothing
//             | is scaled to fit
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "inversion/fit_views.h"
#include "station/compare/compare_pictures.h"
#include "station/documents/spool.h"
#include "station/progress.h"

namespace station {

struct ValidateClothRequest {
  std::filesystem::path rig, weft, out;  // weft: a spool file with simulated fibers, as the warps
  std::vector<std::filesystem::path> warps, drafts;
  std::vector<inversion::ModelKind> models{inversion::ModelKind::thread, inversion::ModelKind::fiber,
                                           inversion::ModelKind::yarn};
  int samples_per_pixel = 64;   // of each of two renderings of every picture
  int photograph_samples = 96;  // of each of the two photographs of a spool's view
  int width_px = 256, height_px = 192;
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct PredictedSample {
  std::string weave, warp, side;  // names of the draft and of the spool's file; "right" or "left", where the lamp is
  int block_px = 0;
  double noise_delta_e = 0;  // of the reference's two renderings, over the root of 2: what its noise alone does
  struct OfModel {
    inversion::ModelKind model;
    Comparison comparison;
  };
  std::vector<OfModel> models;
};

// The patch with every yarn as the fibers of its thread: `spools` by thread index. Each yarn has a bundle of its own, drawn as
// the spool's simulation draws them. Errors: std::runtime_error for a spool whose thread is not as thick as the draft's yarns,
// and those of fiber_centres().
renderer::YarnPatch with_fibers_of(const renderer::YarnPatch& patch, const std::vector<Spool>& spools);

// Pictures in OUT are used again when nothing that they depend on has changed, so that an interrupted run goes on. Written:
// OUT/spools/<spool>/..., OUT/samples/<weave>-<warp>-<side>-<what>.exr, a sheet of all samples (samples.png: reference and
// models beside each other, a row each) and validation.json. Errors: std::runtime_error of files, of rigs without a simulation,
// and when a person has interrupted.
std::vector<PredictedSample> validate_cloth(const ValidateClothRequest& request);

std::string describe(const std::vector<PredictedSample>& samples);
nlohmann::json to_json(const std::vector<PredictedSample>& samples);

}  // namespace station
