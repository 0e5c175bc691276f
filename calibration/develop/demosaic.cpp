#include "calibration/develop/demosaic.h"

#include <algorithm>

namespace calibration {
namespace {

// Green sites form a quincunx, whose neighbours share an edge; red and blue sites form a coarser square grid.
constexpr std::array<std::array<float, 3>, 3> kDense{{{0, 1, 0}, {1, 4, 1}, {0, 1, 0}}};
constexpr std::array<std::array<float, 3>, 3> kCoarse{{{1, 2, 1}, {2, 4, 2}, {1, 2, 1}}};

std::size_t cell_of(int row, int column) {
  return static_cast<std::size_t>(2 * (row & 1) + (column & 1));
}

struct Mixed {
  float radiance = 0, variance = 0;
  bool saturated = false;
};

// `inside`: all neighbours exist.
template <bool inside, bool with_variance>
Mixed mix(const LinearMosaic& raw, int row, int column, const std::vector<MosaicTap>& taps) {
  Mixed sum;
  float weights = 0;
  for (const MosaicTap& tap : taps) {
    const int r = row + tap.row, c = column + tap.column;
    if constexpr (!inside)
      if (r < 0 || c < 0 || r >= raw.radiance.rows || c >= raw.radiance.cols) continue;
    weights += tap.weight;
    sum.radiance += tap.weight * raw.radiance(r, c);
    if constexpr (with_variance) sum.variance += tap.weight * tap.weight * raw.variance(r, c);
    sum.saturated |= raw.saturated(r, c) != 0;
  }
  if (weights > 0) sum.radiance /= weights, sum.variance /= weights * weights;
  return sum;
}

template <bool inside, bool with_variance>
void fill(const LinearMosaic& raw, int row, int column, const MosaicTaps& taps, Developed& out) {
  bool saturated = false;
  for (int c = 0; c < 3; ++c) {
    const Mixed mixed =
        mix<inside, with_variance>(raw, row, column, taps[cell_of(row, column)][static_cast<std::size_t>(c)]);
    out.radiance(row, column)[c] = mixed.radiance;
    if constexpr (with_variance) out.variance(row, column)[c] = mixed.variance;
    saturated |= mixed.saturated;
  }
  out.saturated(row, column) = saturated ? 255 : 0;
}

template <bool with_variance>
void fill_rows(const LinearMosaic& raw, const cv::Range& rows, Developed& out) {
  const MosaicTaps taps = mosaic_taps(raw.channel);
  const int last_row = raw.radiance.rows - 1, last_column = raw.radiance.cols - 1;
  for (int row = rows.start; row < rows.end; ++row) {
    const bool inner_row = row > 0 && row < last_row;
    for (int column = 0; column <= last_column; ++column)
      if (inner_row && column > 0 && column < last_column)
        fill<true, with_variance>(raw, row, column, taps, out);
      else
        fill<false, with_variance>(raw, row, column, taps, out);
  }
}

}  // namespace

MosaicTaps mosaic_taps(const std::array<int, 4>& channel) {
  MosaicTaps taps;
  for (int color = 0; color < 3; ++color) {
    const auto& kernel = std::ranges::count(channel, color) >= 2 ? kDense : kCoarse;
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 2; ++column)
        for (int r = -1; r <= 1; ++r)
          for (int c = -1; c <= 1; ++c) {
            const float weight = kernel[static_cast<std::size_t>(r + 1)][static_cast<std::size_t>(c + 1)];
            if (weight > 0 && channel[cell_of(row + r, column + c)] == color)
              taps[cell_of(row, column)][static_cast<std::size_t>(color)].push_back({r, c, weight});
          }
  }
  return taps;
}

void demosaic_rows(const LinearMosaic& raw, const cv::Range& rows, Developed& out) {
  if (raw.variance.empty())
    fill_rows<false>(raw, rows, out);
  else
    fill_rows<true>(raw, rows, out);
}

}  // namespace calibration
