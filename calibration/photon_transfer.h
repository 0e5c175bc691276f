// Gain, read noise, linearity and true shutter times from pairs of pictures of one still scene at a ladder of exposures.
//
// Pixels are grouped by how bright they are in one reference picture (a bin = one site of the colour cell and one level).
// Every bin's mean signal over all exposures says
//   log signal = log true time + log light of the bin - q * signal / range,
// linear in the unknowns: bright and dim bins of the same picture separate the bend q from the shutter's errors. The pairs'
// differences say variance = gain * signal + read noise^2 (photon transfer: Janesick 2007; EMVA standard 1288).
#pragma once

#include <optional>
#include <vector>

#include "calibration/sensor_maps.h"
#include "calibration/sensor_response.h"

namespace calibration {

struct LevelBins {
  cv::Mat1b bin;  // of each pixel; 255: none
  int count = 0;
};

// `reference`: a picture without saturated pixels in what matters. Throws std::runtime_error when it is too dark or too
// small to make bins.
LevelBins make_level_bins(const SensorPicture& reference, const SensorMaps& maps);

struct BinLevel {
  double pixels = 0;        // 0: not usable (saturated, too dim)
  double signal_dn = 0;     // mean of both pictures, dark taken out
  double variance_dn2 = 0;  // of one picture, from the difference of both
};

struct PairLevels {
  double nominal_s = 0;
  std::vector<BinLevel> bins;
  // How much brighter the second picture is, relative; and how long after the first it began.
  double change = 0, apart_s = 0;
};

// Two pictures of one exposure. `apart_s`: from the first's beginning to the second's; 0: not known.
PairLevels measure_pair(const SensorPicture& first, const SensorPicture& second, const LevelBins& bins,
                        const SensorMaps& maps, double apart_s = 0.0);

struct LinearityPoint {
  double level = 0;      // of the range
  double deviation = 0;  // signal against the straight line through small signals, relative
};

struct TransferPoint {
  double signal_dn = 0, variance_dn2 = 0;  // measured
};

struct PhotonTransfer {
  SensorResponse response;        // all but the maps
  double linearity_residual = 0;  // largest |deviation| of `linearity` below 85 % of the range
  std::vector<LinearityPoint> linearity;
  std::vector<TransferPoint> transfer;
  int levels = 0;      // exposures that were used
  double scatter = 0;  // chi^2 per degree of freedom of the straight-line fit of logarithms
};

// `reference_s`: the nominal time that is taken to be true. Throws std::runtime_error when fewer than 8 exposures, or bins
// of too little contrast, were given.
PhotonTransfer fit_photon_transfer(const std::vector<PairLevels>& ladder, const DarkFit& darks, double range_dn,
                                   double reference_s);

}  // namespace calibration
