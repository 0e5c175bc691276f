// Gain, read noise, linearity and true shutter times from pairs of pictures of one still scene at a ladder of
// exposures.
//
// Pixels are grouped into bins by their brightness in one reference picture; a bin holds one site of the colour cell
// and one level. The mean signal of a bin at each exposure obeys
//   log signal = log true time + log light of the bin - q * signal / range,
// which is linear in the unknowns; bright and dim bins of one picture separate the bend q from the shutter's errors.
// The differences within pairs give variance = gain * signal + read noise^2 (photon transfer: Janesick 2007; EMVA
// standard 1288).
#pragma once

#include <optional>
#include <vector>

#include "calibration/sensor/sensor_maps.h"
#include "calibration/sensor/sensor_response.h"

namespace calibration {

struct LevelBins {
  cv::Mat1b bin;  // each pixel's bin; 255: none
  int count = 0;
};

// The bins of the pixels of `reference`, a picture without saturated pixels where it matters. Throws std::runtime_error
// when it is too dark or too small to make bins.
LevelBins make_level_bins(const SensorPicture& reference, const SensorMaps& maps);

struct BinLevel {
  double pixels = 0;        // number of pixels; 0: the bin is saturated
  double signal_dn = 0;     // mean of both pictures, dark level subtracted
  double variance_dn2 = 0;  // variance of one picture, from the difference of both
};

struct PairLevels {
  double nominal_s = 0;
  std::vector<BinLevel> bins;
  double change = 0;   // how much brighter the second picture is, relative
  double apart_s = 0;  // how long after the first it began; 0: not known
};

// The signals and variances of the bins in two pictures of one exposure, which began `apart_s` after each other.
PairLevels measure_pair(const SensorPicture& first, const SensorPicture& second, const LevelBins& bins,
                        const SensorMaps& maps, double apart_s = 0.0);

struct LinearityPoint {
  double level = 0;      // the signal as a part of the range
  double deviation = 0;  // relative deviation of the signal from the straight line through small signals
};

struct TransferPoint {
  double signal_dn = 0, variance_dn2 = 0;  // measured
};

struct PhotonTransfer {
  SensorResponse response;        // without its maps
  double linearity_residual = 0;  // largest |deviation| of `linearity` below 85 % of the range
  std::vector<LinearityPoint> linearity;
  std::vector<TransferPoint> transfer;
  int levels = 0;      // number of exposures that were used
  double scatter = 0;  // chi^2 per degree of freedom of the straight-line fit of logarithms
};

// Fits the sensor's response to a ladder of exposures. The nominal time `reference_s` is taken to be true. Throws
// std::runtime_error when there are fewer than 8 exposures or the bins have too little contrast.
PhotonTransfer fit_photon_transfer(const std::vector<PairLevels>& ladder, const DarkFit& darks, double range_dn,
                                   double reference_s);

}  // namespace calibration
