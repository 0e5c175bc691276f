// Maps of a sensor's pixels from dark frames and from pictures of an even white surface.
#pragma once

#include <string>
#include <vector>

#include "calibration/picture_stack.h"
#include "calibration/sensor_response.h"

namespace calibration {

struct BadPixels {
  int hot = 0, noisy = 0, dead = 0;
};

struct DarkFit {
  SensorMaps maps;  // bias, dark current and bad pixels (hot and noisy)
  BadPixels bad;
  double bias_dn = 0.0;        // median
  double dark_dn_per_s = 0.0;  // median
  double noise_dn = 0.0;       // of one pixel of one dark frame, rounding included (from the median variance)
  double noise_sigma_dn = 0.0;
  long noise_samples = 0;  // degrees of freedom behind it
};

// `brief`, `lasting`: dark frames (8 or more each) at two exposures; between and beyond them a pixel's dark level is a
// straight line in time. Pixels whose dark current cannot be told from the median's get the median, so that long exposures
// are not made noisier. Hot: brighter than the median by 5 read noises in `lasting`. Noisy: 3 times the median noise.
// Throws std::runtime_error when there are too few frames or the exposures are less than a factor of 4 apart.
DarkFit fit_dark_maps(const PictureStack& brief, const PictureStack& lasting);

// How much higher than the maps say a dark frame is: mean over good pixels, the brightest and darkest thousandth left out. A
// drift of the bias with the day's temperature; light in the dark frame when it is large.
double dark_offset_dn(const SensorPicture& dark, const SensorMaps& maps);

// `flats`: stacks of an even white surface that fills the picture, each from another place, none saturated. Adds dead
// pixels (answer with less than 3/4 of their neighbours, or more than 5/4) to maps.bad, and sets maps.flat: what is left of
// the flats when a surface of 4th order in column and row is taken out, mean of all colours and flats, smoothed over
// `smoothing_px`: dust lies above the pixels and has no sharp edge, the pixels' own pattern averages out in what is measured.
struct FlatFit {
  int dead = 0;
  double flat_noise = 0.0;  // standard deviation that the noise of the flats leaves in maps.flat
  double deepest = 0.0;     // 1 - smallest value of maps.flat
  double covered = 0.0;     // part of the picture where the white surface was seen
};
FlatFit fit_flat_maps(const std::vector<PictureStack>& flats, double white_level_dn, SensorMaps& maps,
                      double smoothing_px = 3.0);

}  // namespace calibration
