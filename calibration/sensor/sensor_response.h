// The response of one sensor at one ISO and aperture: how its numbers become radiance.
//
// DN - dark(p, t) = signal s; light collected = s exp(q s / range), range = white - black level; radiance = light /
// (range * true shutter time * flat(p)), in the radiance unit of the whole program (1 = full scale per second,
// calibration/README.md). Variance of s = gain * s + (gain * read noise)^2 [DN^2].
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace calibration {

// Maps of sensor size. Each may be empty, which means: the file's black level, no dark current, flat, no bad pixel.
struct SensorMaps {
  cv::Mat1f bias_dn;        // dark level at exposure 0
  cv::Mat1f dark_dn_per_s;  // what the dark level gains per second
  cv::Mat1f flat;           // relative sensitivity without the lens's vignetting (dust); 1 where nothing is known
  cv::Mat1b bad;            // 255: a hot, dead or noisy pixel, to be replaced by its neighbours
};

struct ShutterTime {
  double nominal_s = 0.0, true_s = 0.0, sigma_s = 0.0;  // one reference time has true = nominal by definition
};

struct SensorResponse {
  int iso = 100;
  double f_number = 8.0;
  double gain_dn_per_e = 0.0, gain_sigma = 0.0;  // a gain of 0: not known, and pictures get no variances
  double read_noise_e = 0.0, read_noise_sigma = 0.0;
  double nonlinearity = 0.0, nonlinearity_sigma = 0.0;  // q
  std::vector<ShutterTime> shutter;                     // ascending
  SensorMaps maps;
};

// The measured time for a nominal one that is within a sixth of a stop of a calibrated one; other times are returned as
// they are.
double true_exposure_s(const SensorResponse& response, double nominal_s);

// The light that made a signal, both in units of the range.
double linear_signal(const SensorResponse& response, double signal);

}  // namespace calibration
