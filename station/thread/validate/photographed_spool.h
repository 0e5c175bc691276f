// Synthetic photographs of a spool: its simulated fibers, path-traced in 17 ideal views, with a 14-bit sensor's noise.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "inversion/view/view.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"

namespace station {

using PictureHalves = std::array<cv::Mat3f, 2>;  // two photographs of one view, with independent noise

struct PhotographedSpool {
  std::vector<inversion::View> views;  // of synthetic_views(); an image is the mean of both photographs
  std::vector<PictureHalves> pictures;
};

struct SpoolPhotographs {
  std::filesystem::path rig_file, spool_file;  // both determine the photographs
  std::filesystem::path folder;                // where the photographs are kept
  int samples_per_pixel = 96;
  std::uint64_t seed = 1;
};

// Photographs a spool in all views. Photographs that the folder has from the same files are used again. `step` is told
// what is being done and the finished fraction. Errors: std::runtime_error for files that cannot be read or written,
// for a spool without simulated fibers, and when a person has interrupted.
PhotographedSpool photograph_spool(const RigFile& rig, const Spool& spool, const SpoolPhotographs& request,
                                   const std::function<void(const std::string&, double)>& step);

}  // namespace station
