// The values of a scattering model at directions listed in a table, in double precision (`scatter eval`).
//
// Queries (CSV): h, theta_i_rad, phi_i_rad, theta_o_rad, phi_o_rad in the frame of renderer/scattering/lobes.h. The
// offset h belongs to direction o, the viewer's; only phi_i - phi_o matters. For model "fiber" the columns eta,
// sigma_a_r, sigma_a_g, sigma_a_b, beta_m, beta_n, tilt_deg override the parameters row by row; with all of them no
// parameters are needed. Values (CSV): f_cos_r, f_cos_g, f_cos_b (f times the cosine: integrates to the albedo) and
// pdf, the density per solid angle with which the renderer samples direction i; 17 digits, row by row.
//
// Errors: those of number_table.h, reader.h and of writing; std::runtime_error for parameters that are needed and
// missing.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "renderer/scattering/lobes.h"

namespace station {

// An offset and two directions in the frame of lobes.h, direction o at azimuth 0.
struct ScatteringPlace {
  double h = 0;
  renderer::Vec3<double> wi, wo;
};
ScatteringPlace scattering_place(double h, double theta_i_rad, double theta_o_rad, double phi_rad);  // phi_i - phi_o

struct ScatteringQueries {
  std::string model;                 // fiber, thread or yarn
  std::filesystem::path parameters;  // a file of the model's kind; may be empty for fiber
  std::filesystem::path in, out;
};

std::size_t evaluate_queries(const ScatteringQueries& queries);  // returns the number of values written

}  // namespace station
