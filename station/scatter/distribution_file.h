// Files of simulated azimuthal distributions: CSV with the columns phi_rad, density (bin centres; per radian, of the
// rays that met a fiber; phi = 0 is back) and, in lines that start with #, what was simulated and what came out.
//
// Errors: those of number_table.h; notes that are missing.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/scattering/azimuthal_fit.h"
#include "renderer/scattering/multi_fiber.h"

namespace station {

std::string distribution_text(const renderer::MultiFiberOptions& options,
                              const renderer::MultiFiberScattering& scattering);

struct Distribution {
  std::string source;
  double radius_ratio = 0.1;     // fiber / thread
  renderer::AzimuthalData data;  // absorption per fiber radius
};
Distribution read_distribution(const std::filesystem::path& file);

}  // namespace station
