// How uneven a wrapped thread is along itself: its shade and its thickness, by what all photographs of it show in the
// same place and its even fitted twin does not.
//
// Places of the sheet are cells: a few turns by a few millimetres along them. A cell's brightness over its twin's, less
// what changes slowly over the sheet (light and the model's errors do), is averaged over half of the views and over the
// other half; the covariance of the two has none of the photographs' noise. A turn follows another one turn's length
// of thread later, so that cells in and across turns tell over what length the thread stays alike. Thickness shows in
// where turns lie: the phase of their pattern in a window moves as the thread before it is thicker or thinner.
//
// Brightness is told as it is seen. Of the shades behind it less is told than there is, because what one turn scatters
// lights its neighbours too: of 0.41 in silk, whose turns lie close, 0.25 (tests/station/bench/spool_fibers_test.cpp).
#pragma once

#include <Eigen/Core>
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

// `fitted`: pictures of the even thread, one for each view, in its radiance unit. `darkening`: by how much the
// logarithm of the brightness of R, G and B falls for each unit of the absorption's logarithm. Views by transmission
// are left out, for they show what is behind as well; nothing is told where fewer than four are left or the sheet is
// too small.
Irregularity measure_irregularity(const WrappedSpool& spool, const std::vector<View>& views,
                                  const std::vector<cv::Mat3f>& fitted, const Eigen::Array3d& darkening);

// One turn of the thread round the holder, mm.
double turn_length_mm(const WrappedSpool& spool);

}  // namespace inversion
