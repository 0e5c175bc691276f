#include "calibration/develop/linear_grey.h"

#include <algorithm>
#include <array>
#include <vector>

#include "calibration/develop/demosaic.h"
#include "calibration/sensor/developable.h"

namespace calibration {
namespace {

// The weights of the 3 x 3 raw values around a pixel, row by row, in the mean of the pixel's colours.
using Weights = std::array<float, 9>;

std::array<Weights, 4> grey_weights(const std::array<int, 4>& channel) {
  const MosaicTaps taps = mosaic_taps(channel);
  std::array<Weights, 4> weights{};
  for (std::size_t cell = 0; cell < 4; ++cell)
    for (const std::vector<MosaicTap>& of_color : taps[cell]) {
      float sum = 0;
      for (const MosaicTap& tap : of_color) sum += tap.weight;
      for (const MosaicTap& tap : of_color)
        weights[cell][static_cast<std::size_t>(3 * (tap.row + 1) + tap.column + 1)] += tap.weight / sum / 3;
    }
  return weights;
}

// The weights of a run of kRun pixels of a row that begins at an odd column. The weights alternate from column to
// column, so the compiler can vectorise a loop over a run.
constexpr int kRun = 8;
using RunWeights = std::array<std::array<float, kRun>, 9>;

RunWeights run_weights(const std::array<Weights, 4>& weights, int row) {
  RunWeights run{};
  for (std::size_t i = 0; i < kRun; ++i)
    for (std::size_t tap = 0; tap < 9; ++tap)
      run[tap][i] = weights[static_cast<std::size_t>(2 * (row & 1)) + (i + 1) % 2][tap];
  return run;
}

float mean_of_colours(const SensorPicture& picture, int row, int column,
                      const std::array<std::vector<MosaicTap>, 3>& taps) {
  float grey = 0;
  for (const std::vector<MosaicTap>& of_color : taps) {
    float sum = 0, weights = 0;
    for (const MosaicTap& tap : of_color) {
      const int r = row + tap.row, c = column + tap.column;
      if (r < 0 || c < 0 || r >= picture.mosaic.rows || c >= picture.mosaic.cols) continue;
      weights += tap.weight;
      sum += tap.weight * (static_cast<float>(picture.mosaic(r, c)) - static_cast<float>(picture.black_level_dn));
    }
    if (weights > 0) grey += sum / weights / 3;
  }
  return grey;
}

}  // namespace

cv::Mat1f linear_grey(const SensorPicture& picture) {
  require_developable(picture);
  cv::Mat1f grey(picture.mosaic.size());
  const auto black = static_cast<float>(picture.black_level_dn);
  const auto per_dn = static_cast<float>(1 / ((picture.white_level_dn - picture.black_level_dn) * picture.exposure_s));
  const std::array<Weights, 4> weights = grey_weights(picture.channel);
  const MosaicTaps taps = mosaic_taps(picture.channel);
  const int last_row = grey.rows - 1, last_column = grey.cols - 1;
  cv::parallel_for_({0, grey.rows}, [&](const cv::Range& rows) {
    for (int row = rows.start; row < rows.end; ++row) {
      float* out = grey[row];
      const auto one_pixel = [&](int column) {
        const auto cell = static_cast<std::size_t>(2 * (row & 1) + (column & 1));
        out[column] = std::max(0.F, mean_of_colours(picture, row, column, taps[cell]) * per_dn);
      };
      if (row == 0 || row == last_row) {
        for (int column = 0; column <= last_column; ++column) one_pixel(column);
        continue;
      }
      one_pixel(0);
      one_pixel(last_column);
      const std::array<const ushort*, 3> in{picture.mosaic[row - 1], picture.mosaic[row], picture.mosaic[row + 1]};
      const RunWeights run = run_weights(weights, row);
      int column = 1;
      for (; column + kRun <= last_column; column += kRun) {
        std::array<float, kRun> sums{};
        for (std::size_t r = 0; r < 3; ++r)
          for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < kRun; ++i)
              sums[i] += run[3 * r + c][i] * (static_cast<float>(in[r][column - 1 + static_cast<int>(c + i)]) - black);
        for (std::size_t i = 0; i < kRun; ++i) out[column + static_cast<int>(i)] = std::max(0.F, sums[i] * per_dn);
      }
      for (; column < last_column; ++column) one_pixel(column);
    }
  });
  return grey;
}

}  // namespace calibration
