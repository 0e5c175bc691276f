// The BRDF of the cloth that a thread weaves into, as a table for renderers that know no cloth.
#pragma once

#include <filesystem>
#include <string>

#include "station/documents/thread_file.h"
#include "station/output/progress.h"

namespace station {

// The largest anisotropy (cloth_reflectance.h, anisotropy()) at which a table without the cloth's turn still describes
// the cloth.
inline constexpr double kMostAnisotropy = 0.25;

struct ClothBrdfRequest {
  std::filesystem::path draft;     // scaled to the thread's diameter, the thread in warp and weft
  bool allow_anisotropic = false;  // above the limit, take the mean over all turns
  int samples_per_cell = 8;
  std::uint64_t seed = 1;
};

struct ClothBrdf {
  std::string draft;      // the draft's name
  double anisotropy = 0;  // relative
  double noise = 0;       // relative standard error of a cell
  double cover = 0;       // share of the plane that yarns hide; black is behind the rest
  std::string merl;       // bytes of the MERL file, linear sRGB
};

// Measures the BRDF. Errors: std::runtime_error, one line: those of the draft; anisotropy above kMostAnisotropy that
// was not allowed; stopped by ctrl-C.
ClothBrdf cloth_brdf(const ThreadFile& thread, const ClothBrdfRequest& request, ProgressDisplay& progress);

}  // namespace station
