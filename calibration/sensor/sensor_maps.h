// Fits of a sensor's pixel maps (SensorMaps) to dark frames and to pictures of an even white surface.
#pragma once

#include <string>
#include <vector>

#include "calibration/sensor/picture_stack.h"
#include "calibration/sensor/sensor_response.h"

namespace calibration {

struct BadPixels {
  int hot = 0, noisy = 0, dead = 0;
};

struct DarkFit {
  SensorMaps maps;  // bias, dark current and bad pixels (hot and noisy)
  BadPixels bad;
  double bias_dn = 0.0;        // mean over good pixels
  double dark_dn_per_s = 0.0;  // median
  double noise_dn = 0.0;  // standard deviation of a pixel from frame to frame, rounding included; noisy ones left out
  double noise_sigma_dn = 0.0;  // standard error of noise_dn
  long noise_samples = 0;       // degrees of freedom behind noise_dn
};

// Fits a straight line in exposure time to each pixel's dark level, from two stacks of 8 or more dark frames: `brief`
// at a short exposure, `lasting` at a long one. A pixel whose dark current is within 5 standard errors of the median
// gets the median, so that long exposures are not made noisier. A hot pixel is brighter than the median by 5 read
// noises in `lasting`; a noisy one has 3 times the median noise. Throws std::runtime_error when there are too few
// frames or the exposures are less than a factor of 4 apart.
DarkFit fit_dark_maps(const PictureStack& brief, const PictureStack& lasting);

// By how many DN a dark frame is brighter than the maps say: the mean over good pixels, without the brightest and the
// darkest thousandth. A small value is a drift of the bias with temperature, a large one light in the dark frame.
double dark_offset_dn(const SensorPicture& dark, const SensorMaps& maps);
inline constexpr double kMostDarkOffset = 1e-3;  // of the range, before it is light; a bias drifts by a DN or two

struct FlatFit {
  int dead = 0;             // number of dead pixels
  double flat_noise = 0.0;  // standard deviation that the noise of the flats leaves in maps.flat
  double deepest = 0.0;     // 1 - smallest value of maps.flat
  double covered = 0.0;     // part of the picture where the white surface was seen
};

// Finds dead pixels and dust in `flats`: stacks of an even white surface that fills the picture, each taken from
// another place, none saturated. Adds the dead pixels (those that answer with less than 3/4 or more than 5/4 of the
// light around them) to maps.bad. Sets maps.flat: each flat divided by a smooth surface of 4th order in column and row,
// averaged over all colours and flats and smoothed over `smoothing_px`. Smoothing keeps dust, which lies above the
// pixels and has no sharp edge; the pattern of the pixels themselves averages out in later measurements.
FlatFit fit_flat_maps(const std::vector<PictureStack>& flats, double white_level_dn, SensorMaps& maps,
                      double smoothing_px = 3.0);

}  // namespace calibration
