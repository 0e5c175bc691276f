// The BRDF of the cloth that a thread weaves into, as a table for renderers that know no cloth.
#pragma once

#include <filesystem>
#include <string>

#include "station/documents/thread_file.h"
#include "station/progress.h"

namespace station {

// Above it a table that forgets how the cloth is turned says little of the cloth (cloth_reflectance.h, anisotropy()).
inline constexpr double kMostAnisotropy = 0.25;

struct ClothBrdfRequest {
  std::filesystem::path draft;     // scaled to the thread's diameter, the thread in warp and weft
  bool allow_anisotropic = false;  // the mean over all turns is wanted even so
  int samples_per_cell = 8;
  std::uint64_t seed = 1;
};

struct ClothBrdf {
  std::string draft;      // its name
  double anisotropy = 0;  // relative
  double noise = 0;       // relative standard error of a cell
  double cover = 0;       // share of the plane that yarns hide; light that goes through meets black
  std::string merl;       // the file's bytes, linear sRGB
};

// Errors: std::runtime_error, one line: of the draft; more anisotropy than kMostAnisotropy that was not allowed;
// stopped by ctrl-C.
ClothBrdf cloth_brdf(const ThreadFile& thread, const ClothBrdfRequest& request, ProgressDisplay& progress);

}  // namespace station
