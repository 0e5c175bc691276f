// A file as the MERL BRDF database has it [Matusik et al. 2003, "A Data-Driven Reflectance Model"] and its authors'
// BRDFRead.cpp reads it: three 32-bit integers 90, 90, 180, then 64-bit floats, three planes R, G, B of theta_h x
// theta_d x phi_d cells (merl_directions), each BRDF divided by the channel's scale. A negative value stands for a
// direction below the horizon. Little-endian.
#pragma once

#include <array>
#include <string>

#include "renderer/trace/cloth_reflectance.h"

namespace station {

inline constexpr std::array<double, 3> kMerlScale{1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

// The bytes of the file; `colours` is applied to each value first, and what is then negative becomes 0.
std::string merl_bytes(const renderer::MerlGrid& grid, const Eigen::Matrix3d& colours);

}  // namespace station
