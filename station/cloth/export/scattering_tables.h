// Tables of a thread's scattering function on a grid of directions, as CSV and as NumPy arrays. The values are those of
// `scatter eval` (same code), in camera RGB.
//
//   axis        | grid                     | count
//   theta_o_rad | 0, 10, ... 80 deg        | 9    a thread without tilt scatters alike at -theta_o, with -theta_i
//   theta_i_rad | -90, -85, ... 90 deg     | 37
//   phi_rad     | 0, 10, ... 350 deg       | 36   phi_i - phi_o: 0 back to the viewer, 180 deg onward
//   h           | -0.875, -0.625 ... 0.875 | 8    direction o's offset
//
// Means over h are taken over 64 offsets in even steps. Lobes narrower than the steps (roughness below about 0.15) fall
// between them; `scatter eval` gives finer ones.
#pragma once

#include <string>
#include <vector>

#include "station/documents/thread_file.h"

namespace station {

struct ScatteringTables {
  std::vector<double> theta_o_rad, theta_i_rad, phi_rad, h;
  std::vector<double> f_cos;       // [theta_o][theta_i][phi][h][RGB], the last fastest
  std::vector<double> f_cos_mean;  // [theta_o][theta_i][phi][RGB]
};
ScatteringTables scattering_tables(const renderer::ThreadParameters& thread);

// The CSV texts with the columns h, theta_i_rad, phi_i_rad, theta_o_rad, phi_o_rad (which `scatter eval` reads),
// f_cos_r, f_cos_g, f_cos_b; the mean's has no h. f_cos includes the cosine and is per steradian; 9 digits.
std::string scattering_csv(const ScatteringTables& tables);
std::string mean_scattering_csv(const ScatteringTables& tables);

struct NamedBytes {
  std::string name, bytes;
};
// The NumPy files: f_cos.npy, f_cos_mean.npy (float64, C order, axes as above) and one for each axis.
std::vector<NamedBytes> scattering_arrays(const ScatteringTables& tables);

}  // namespace station
