#include "rig/simulated/sensor_defects.h"

#include <cmath>

#include "rig/simulated/noise.h"

namespace rig {
namespace {

// Numbers of the random streams, far from those of the pictures' noise, which are counted from 1.
constexpr std::uint64_t kPixelStream = 1ull << 60, kDustStream = 2ull << 60, kShutterStream = 3ull << 60;

void add_dust(const SensorDefects& defects, std::uint64_t seed, cv::Mat1f& sensitivity) {
  NoiseStream chance(seed, kDustStream);
  for (int spot = 0; spot < defects.dust_spots; ++spot) {
    const double x = chance.uniform() * sensitivity.cols, y = chance.uniform() * sensitivity.rows;
    for (int row = 0; row < sensitivity.rows; ++row)
      for (int column = 0; column < sensitivity.cols; ++column) {
        const double r = std::hypot(column - x, row - y) / defects.dust_radius_px;
        sensitivity(row, column) *= static_cast<float>(1 - defects.dust_depth * std::exp(-r * r));
      }
  }
}

}  // namespace

DefectMaps defect_maps(const SensorDefects& defects, cv::Size size, std::uint64_t seed) {
  DefectMaps maps{.sensitivity = cv::Mat1f(size, 1.0F),
                  .offset_dn = cv::Mat1f(size, 0.0F),
                  .dark_current_e_s = cv::Mat1f(size, 0.0F),
                  .read_noise_factor = cv::Mat1f(size, 1.0F)};
  NoiseStream chance(seed, kPixelStream);
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      const auto [sensitivity, offset] = chance.normals();
      const double kind = chance.uniform(), degree = chance.uniform();
      maps.sensitivity(row, column) = static_cast<float>(1 + defects.sensitivity_spread * sensitivity);
      maps.offset_dn(row, column) = static_cast<float>(defects.offset_spread_dn * offset);
      if (kind < defects.hot_fraction)
        maps.dark_current_e_s(row, column) = static_cast<float>(defects.hot_dark_current_e_s * (0.5 + degree));
      else if (kind < defects.hot_fraction + defects.dead_fraction)
        maps.sensitivity(row, column) = static_cast<float>(0.2 * degree);
      else if (kind < defects.hot_fraction + defects.dead_fraction + defects.noisy_fraction)
        maps.read_noise_factor(row, column) = 10;
    }
  if (defects.dust_radius_px > 0) add_dust(defects, seed, maps.sensitivity);
  return maps;
}

double shutter_factor(const SensorDefects& defects, double nominal_s, std::uint64_t seed) {
  NoiseStream chance(seed, kShutterStream + static_cast<std::uint64_t>(std::llround(nominal_s * 1e6)));
  return std::exp(defects.shutter_spread * chance.normals().first);
}

}  // namespace rig
