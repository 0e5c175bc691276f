// How uneven a wrapped thread is along itself: its shade and its thickness, by what all photographs of it show in the
// same place and its even fitted twin does not.
//
// Places of the sheet are cells: a few turns by a few millimetres along them. A cell's brightness over its twin's, less
// what changes slowly over the sheet (light and the model's errors do), is averaged over half of the views and over the
// other half; the covariance of the two has none of the photographs' noise. A turn follows another one turn's length
// of thread later, so that cells in and across turns tell over what length the thread stays alike. Thickness shows in
// where turns lie: the phase of their pattern in a window moves as the thread before it is thicker or thinner.
//
// Cells mix turns, and slow changes are taken away: how much is left of a thread's variance is counted on random ones.
// Of the shades behind its brightness, what views tell of known ones is measured on pictures of the fitted thread.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "inversion/view/view.h"

namespace inversion {

struct Deviation {
  double value = 0, sigma = 0;  // a standard deviation along the thread, and its standard error
};

struct Irregularity {
  std::optional<Deviation> brightness;  // of the light that it sends back, as a share; mean of R, G and B
  std::optional<Deviation> shade;       // of the logarithm of its absorption
  std::optional<Deviation> diameter;    // as a share; nothing where the turns are not seen one by one
  double length_mm = 0;                 // of thread, over which the correlation of its brightness falls to 1 / e
};

// Pictures of the fitted thread, in the views' places and radiance units.
struct FittedTwins {
  std::vector<cv::Mat3f> even;  // one for each view
  // By how much the logarithm of the brightness of R, G and B falls for each unit of the absorption's logarithm.
  Eigen::Array3d darkening = Eigen::Array3d::Zero();
  // The picture of the view of this index, each turn, from bottom to top, with exp(shade) times the absorption.
  std::function<cv::Mat3f(std::size_t view, const std::vector<double>& shades)> shaded;
};

// Views by transmission are left out, for they show what is behind as well; nothing is told where fewer than four are
// left or the sheet is too small.
Irregularity measure_irregularity(const WrappedSpool& spool, const std::vector<View>& views, const FittedTwins& twins);

// One turn of the thread round the holder, mm.
double turn_length_mm(const WrappedSpool& spool);

}  // namespace inversion
