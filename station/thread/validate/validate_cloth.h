// Validation of cloth that is predicted from digitized threads [Xia 2025, section 6, figures 10 and 11], on synthetic
// samples, where the truth is known.
//
//   spool     | simulated fibers, photographed in 17 views and fitted with the thread model and both baselines
//   sample    | each weave in each warp colour, all with the same weft: on the black cylinder, lit from right and left,
//             | and as an upright swatch with the lamp behind it
//   reference | the same cloth, every yarn made of the fibers of its spool: a patch of fibers in two scales, of so many
//             | yarns, each with a bundle of its own, that it does not hang on how a few bundles fell
//   table     | CIEDE2000 of block averages, the mean radiance over the reference's in each channel, and place, width,
//             | height and hue of the highlight, all in one unit of radiance: nothing is scaled to fit
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "inversion/fit/fit_views.h"
#include "station/documents/spool.h"
#include "station/output/compare/compare_pictures.h"
#include "station/output/progress.h"

namespace station {

struct ValidateClothRequest {
  std::filesystem::path rig, weft, out;  // weft and warps: spool files with simulated fibers
  std::vector<std::filesystem::path> warps, drafts;
  std::vector<inversion::ModelKind> models{inversion::ModelKind::thread, inversion::ModelKind::fiber,
                                           inversion::ModelKind::yarn};
  bool true_fibers = false;  // besides, predict with each spool's own fibers as a bundle: what no fit can better
  renderer::ThreadExit exit = renderer::ThreadParameters{}.exit;  // of the thread model
  std::vector<int> paths_per_block{};                             // of fits (FitOptions); empty: each model's own
  int samples_per_pixel = 64;                                     // in each of the two renderings of every picture
  int photograph_samples = 96;                                    // in each of the two photographs of a spool's view
  int width_px = 256, height_px = 192;
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct PredictedSample {
  std::string weave, warp, side;  // weave and warp: names of their files; side of the lamp: "right", "left", "behind"
  int block_px = 0;
  // The noise of the reference, which is the mean of two renderings: half their difference.
  double noise_delta_e = 0;
  struct OfModel {
    std::string model;  // its name; "true fibers" for those of the spool
    Comparison comparison;
  };
  std::vector<OfModel> models;
};

// The patch with every yarn replaced by the round fibers of its thread; `spools` is indexed by thread. Each yarn has a
// bundle of its own, drawn in its section, round or flat, as the spool's simulation draws bundles; that of a ply is as
// much smaller, with its fibers, as the ply is thinner than the thread. Errors: those of fiber_centres().
renderer::YarnPatch with_fibers_of(const renderer::YarnPatch& patch, const std::vector<Spool>& spools);

// Runs the validation. Pictures in OUT are used again when nothing that they depend on has changed, so that an
// interrupted run goes on. Written are OUT/spools/<spool>/..., OUT/samples/<weave>-<warp>-<side>-<what>.exr, a sheet of
// all samples (samples.png: a row each, reference and models beside each other) and validation.json. Errors:
// std::runtime_error for files, for a rig without a simulation, and when a person has interrupted.
std::vector<PredictedSample> validate_cloth(const ValidateClothRequest& request);

std::string describe(const std::vector<PredictedSample>& samples);
nlohmann::json to_json(const std::vector<PredictedSample>& samples);

}  // namespace station
