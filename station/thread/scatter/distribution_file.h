// A file of a simulated azimuthal distribution: CSV with the columns phi_rad (bin centres, 0 is back towards the light)
// and density (per radian, of the rays that met a fiber). Lines that start with # note what was simulated and what came
// out.
//
// Errors: those of number_table.h, also for notes that are missing.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/scattering/azimuthal_fit.h"
#include "renderer/scattering/multi_fiber.h"

namespace station {

// The text of the file.
std::string distribution_text(const renderer::MultiFiberOptions& options,
                              const renderer::MultiFiberScattering& scattering);

struct Distribution {
  std::string source;
  double radius_ratio = 0.1;     // fiber radius / thread radius
  renderer::AzimuthalData data;  // absorption per fiber radius
};
Distribution read_distribution(const std::filesystem::path& file);

}  // namespace station
