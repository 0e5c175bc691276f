#include "calibration/light/spectralon.h"

#include <array>

#include "calibration/light/droop_shape.h"

namespace calibration {
namespace {

constexpr int kAngles = 8;
using Plane = std::array<std::array<double, kAngles>, kAngles>;  // [incidence][view]

// The published table at phi = 0, 90, 180 degrees; fixtures/reference/spectralon says where it comes from.
constexpr std::array<Plane, 3> kPublished{{{{{{1.102, 1.098, 1.087, 1.071, 1.049, 1.023, 0.992, 0.956}},
                                             {{1.094, 1.090, 1.079, 1.062, 1.040, 1.014, 0.983, 0.947}},
                                             {{1.077, 1.076, 1.068, 1.051, 1.027, 0.999, 0.969, 0.934}},
                                             {{1.055, 1.054, 1.050, 1.038, 1.015, 0.984, 0.951, 0.917}},
                                             {{1.028, 1.026, 1.021, 1.016, 1.001, 0.973, 0.934, 0.896}},
                                             {{0.993, 0.990, 0.982, 0.975, 0.972, 0.955, 0.922, 0.875}},
                                             {{0.941, 0.938, 0.930, 0.919, 0.912, 0.913, 0.897, 0.860}},
                                             {{0.868, 0.865, 0.858, 0.846, 0.833, 0.828, 0.837, 0.825}}}},
                                           {{{{1.101, 1.097, 1.087, 1.071, 1.049, 1.023, 0.992, 0.956}},
                                             {{1.091, 1.087, 1.078, 1.063, 1.043, 1.019, 0.990, 0.956}},
                                             {{1.075, 1.072, 1.064, 1.052, 1.034, 1.012, 0.986, 0.956}},
                                             {{1.054, 1.053, 1.047, 1.037, 1.022, 1.004, 0.981, 0.956}},
                                             {{1.028, 1.028, 1.024, 1.017, 1.006, 0.992, 0.974, 0.954}},
                                             {{0.993, 0.994, 0.993, 0.989, 0.983, 0.974, 0.962, 0.949}},
                                             {{0.942, 0.944, 0.945, 0.945, 0.943, 0.941, 0.939, 0.936}},
                                             {{0.869, 0.872, 0.876, 0.878, 0.881, 0.886, 0.896, 0.909}}}},
                                           {{{{1.101, 1.097, 1.087, 1.071, 1.050, 1.024, 0.992, 0.957}},
                                             {{1.091, 1.089, 1.082, 1.070, 1.053, 1.032, 1.006, 0.976}},
                                             {{1.075, 1.076, 1.073, 1.067, 1.057, 1.043, 1.026, 1.006}},
                                             {{1.055, 1.059, 1.062, 1.063, 1.061, 1.057, 1.051, 1.044}},
                                             {{1.029, 1.037, 1.047, 1.056, 1.064, 1.071, 1.081, 1.099}},
                                             {{0.994, 1.006, 1.023, 1.042, 1.063, 1.088, 1.125, 1.191}},
                                             {{0.942, 0.959, 0.981, 1.010, 1.048, 1.104, 1.195, 1.360}},
                                             {{0.869, 0.888, 0.916, 0.953, 1.011, 1.113, 1.305, 1.672}}}}}};

std::array<double, 3 * kAngles * kAngles> fourier_coefficients() {
  std::array<double, 3 * kAngles * kAngles> out{};
  for (std::size_t i = 0; i < kAngles; ++i)
    for (std::size_t e = 0; e < kAngles; ++e) {
      const double back = kPublished[0][i][e], across = kPublished[1][i][e], forward = kPublished[2][i][e];
      const std::size_t at = 3 * (i * kAngles + e);
      out[at] = (back + forward) / 4 + across / 2;
      out[at + 1] = (back - forward) / 2;
      out[at + 2] = (back + forward) / 4 - across / 2;
    }
  return out;
}

}  // namespace

const DroopTable& droop_table() {
  static const auto coefficients = fourier_coefficients();
  static const ceres::Grid2D<double, 3> grid(coefficients.data(), 0, kAngles, 0, kAngles);
  static const DroopTable table(grid);
  return table;
}

double droop_shape(double cos_theta_i, double cos_theta_e, double cos_phi) {
  return droop_shape<double>(cos_theta_i, cos_theta_e, cos_phi);
}

}  // namespace calibration
