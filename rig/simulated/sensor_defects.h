// The defects of the simulated sensor, pixel by pixel: all that it has beside noise. The same seed gives the same ones.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rig {

// Fractions are parts of all pixels. The defaults describe a perfect sensor.
struct SensorDefects {
  // Hot pixels add to the sensor's dark current 0.5 to 1.5 times this one, by chance.
  double hot_fraction = 0.0, hot_dark_current_e_s = 0.0;
  double dead_fraction = 0.0;       // dead pixels answer with a fifth of the light or less
  double noisy_fraction = 0.0;      // noisy pixels have ten times the read noise
  double sensitivity_spread = 0.0;  // fixed pattern: relative standard deviation of the pixels' sensitivities
  double offset_spread_dn = 0.0;    // standard deviation of the pixels' black levels
  int dust_spots = 0;
  double dust_depth = 0.0;      // part of the light that the middle of a spot takes away
  double dust_radius_px = 0.0;  // where a spot takes away 1 / e of that; spots are smooth, dust lies above the pixels
  double nonlinearity = 0.0;    // electrons counted = e (1 - nonlinearity e / full well)
  double shutter_spread = 0.0;  // standard deviation of log(true time / nominal), one error per shutter time
};

struct DefectMaps {
  cv::Mat1f sensitivity;       // factor on the light: dust, fixed pattern, dead pixels
  cv::Mat1f offset_dn;         // added to the black level
  cv::Mat1f dark_current_e_s;  // added to the sensor's own
  cv::Mat1f read_noise_factor;
};

// The defects of each pixel of a sensor of this size.
DefectMaps defect_maps(const SensorDefects& defects, cv::Size size, std::uint64_t seed);

// True over nominal shutter time; each nominal time has its own error.
double shutter_factor(const SensorDefects& defects, double nominal_s, std::uint64_t seed);

}  // namespace rig
