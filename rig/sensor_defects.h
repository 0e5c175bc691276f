// What the simulated sensor has beside noise, pixel by pixel; the same for the same seed.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rig {

// All 0: a perfect sensor. Fractions are of all pixels.
struct SensorDefects {
  double hot_fraction = 0.0, hot_dark_current_e_s = 0.0;  // beside the sensor's own; 0.5 to 1.5 times that, by chance
  double dead_fraction = 0.0;                             // answer with a fifth of the light or less
  double noisy_fraction = 0.0;                            // ten times the read noise
  double sensitivity_spread = 0.0;                        // fixed pattern: relative standard deviation of a pixel's
  double offset_spread_dn = 0.0;                          // standard deviation of a pixel's black level
  int dust_spots = 0;
  double dust_depth = 0.0;      // light that a spot's middle takes away
  double dust_radius_px = 0.0;  // 1 / e of it is left there: smooth spots, because dust lies above the pixels
  double nonlinearity = 0.0;    // counted = e (1 - nonlinearity e / full well)
  double shutter_spread = 0.0;  // standard deviation of log(true time / nominal), one error per shutter time
};

struct DefectMaps {
  cv::Mat1f sensitivity;       // factor of the light: dust, fixed pattern, dead pixels
  cv::Mat1f offset_dn;         // on the black level
  cv::Mat1f dark_current_e_s;  // beside the sensor's own
  cv::Mat1f read_noise_factor;
};

DefectMaps defect_maps(const SensorDefects& defects, cv::Size size, std::uint64_t seed);

// True time / nominal; nominal times that differ have errors of their own.
double shutter_factor(const SensorDefects& defects, double nominal_s, std::uint64_t seed);

}  // namespace rig
