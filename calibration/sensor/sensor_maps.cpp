#include "calibration/sensor/sensor_maps.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "calibration/sensor/median.h"
#include "calibration/sensor/sensor_range.h"

namespace calibration {
namespace {

constexpr int kFewestDarks = 8;
constexpr int kCells = 4;  // sites of the 2 x 2 cell; the pixels at one site form a plane

double median(const cv::Mat1f& values, const cv::Mat1b& leave_out = {}) {
  std::vector<float> all;
  all.reserve(values.total());
  for (int row = 0; row < values.rows; ++row)
    for (int column = 0; column < values.cols; ++column)
      if (leave_out.empty() || !leave_out(row, column)) all.push_back(values(row, column));
  if (all.empty()) return 0.0;
  return static_cast<double>(calibration::median<float>(std::move(all)));
}

template <typename T>
cv::Mat_<T> plane_of(const cv::Mat_<T>& mosaic, int cell) {
  const cv::Size size((mosaic.cols - cell % 2 + 1) / 2, (mosaic.rows - cell / 2 + 1) / 2);
  cv::Mat_<T> plane(size);
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column)
      plane(row, column) = mosaic(2 * row + cell / 2, 2 * column + cell % 2);
  return plane;
}

// All products of powers of column and row (-1 to 1 across the plane) up to 4th order.
Eigen::Matrix<double, 15, 1> surface_terms(double x, double y) {
  Eigen::Matrix<double, 15, 1> terms;
  Eigen::Index i = 0;
  for (int order = 0; order <= 4; ++order)
    for (int in_y = 0; in_y <= order; ++in_y) terms(i++) = std::pow(x, order - in_y) * std::pow(y, in_y);
  return terms;
}

struct RelativePlane {
  cv::Mat1f value;   // plane / its smooth surface
  cv::Mat1b usable;  // 255 where a good pixel saw the white surface
};

// Fits the surface three times; after the first, pixels more than 3 standard deviations off (dust, bad pixels) are left
// out.
RelativePlane relative_to_surface(const cv::Mat1f& plane, const cv::Mat1b& bad) {
  cv::Mat1f without_dots;  // the plane without single dark pixels, which are not outside of the white surface
  cv::medianBlur(plane, without_dots, 5);
  RelativePlane out{.value = cv::Mat1f(plane.size(), 1.0F), .usable = cv::Mat1b(without_dots > 0.5 * median(plane))};
  cv::erode(out.usable, out.usable, cv::Mat1b::ones(9, 9));
  out.usable &= ~bad;
  const auto x_of = [&](int column) { return 2.0 * column / plane.cols - 1; };
  const auto y_of = [&](int row) { return 2.0 * row / plane.rows - 1; };
  double allowed = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::Matrix<double, 15, 15> normal = Eigen::Matrix<double, 15, 15>::Zero();
    Eigen::Matrix<double, 15, 1> right = Eigen::Matrix<double, 15, 1>::Zero();
    for (int row = 0; row < plane.rows; ++row)
      for (int column = 0; column < plane.cols; ++column) {
        if (!out.usable(row, column) || std::abs(static_cast<double>(out.value(row, column)) - 1) > allowed) continue;
        const auto terms = surface_terms(x_of(column), y_of(row));
        normal.selfadjointView<Eigen::Lower>().rankUpdate(terms);
        right += terms * static_cast<double>(plane(row, column));
      }
    const Eigen::Matrix<double, 15, 1> surface =
        Eigen::Matrix<double, 15, 15>(normal.selfadjointView<Eigen::Lower>()).ldlt().solve(right);
    double squares = 0;
    int count = 0;
    for (int row = 0; row < plane.rows; ++row)
      for (int column = 0; column < plane.cols; ++column) {
        if (!out.usable(row, column)) continue;
        const double value = plane(row, column) / surface.dot(surface_terms(x_of(column), y_of(row)));
        if (std::abs(value - 1) < allowed) squares += (value - 1) * (value - 1), ++count;
        out.value(row, column) = static_cast<float>(value);
      }
    allowed = 3 * std::sqrt(squares / std::max(count, 1));
  }
  return out;
}

using Planes = std::array<RelativePlane, kCells>;

// The mean pictures of the white surface without their dark level.
std::vector<cv::Mat1f> white_signals(const std::vector<PictureStack>& flats, double white_level_dn,
                                     const SensorMaps& maps) {
  std::vector<cv::Mat1f> signals;
  for (const PictureStack& flat : flats) {
    const cv::Mat1f mean = flat.mean_dn();
    if (mean.size() != maps.bias_dn.size())
      throw std::runtime_error("flat field: the pictures' sizes differ: use one camera");
    if (median(mean) > kBrightest * white_level_dn)
      throw std::runtime_error("flat field: the white surface is saturated: take it with a shorter exposure");
    signals.emplace_back(mean - maps.bias_dn - maps.dark_dn_per_s * flat.exposure_s());
  }
  return signals;
}

std::vector<Planes> relative_planes(const std::vector<cv::Mat1f>& signals, const cv::Mat1b& bad) {
  std::vector<Planes> relative(signals.size());
  for (std::size_t flat = 0; flat < signals.size(); ++flat)
    for (int cell = 0; cell < kCells; ++cell)
      relative[flat][static_cast<std::size_t>(cell)] =
          relative_to_surface(plane_of(signals[flat], cell), plane_of(bad, cell));
  return relative;
}

// The pixels (255) whose mean relative value is far from 1.
cv::Mat1b dead_pixels(const std::vector<Planes>& relative, const cv::Size& size) {
  cv::Mat1b dead(size, uchar{0});
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      float sum = 0, count = 0;
      for (const Planes& planes : relative) {
        const RelativePlane& plane = planes[static_cast<std::size_t>(row % 2 * 2 + column % 2)];
        if (plane.usable(row / 2, column / 2)) sum += plane.value(row / 2, column / 2), count += 1;
      }
      if (count > 0 && (sum / count < 0.75F || sum / count > 1.25F)) dead(row, column) = 255;
    }
  return dead;
}

// The mean of `sum` / `weight` over a Gaussian window; 1 where the window holds nearly no usable pixel.
cv::Mat1f smoothed(const cv::Mat1f& sum, const cv::Mat1f& weight, double sigma_px) {
  cv::Mat1f top, bottom;
  cv::GaussianBlur(sum, top, {0, 0}, sigma_px);
  cv::GaussianBlur(weight, bottom, {0, 0}, sigma_px);
  cv::Mat1f out(sum.size(), 1.0F);
  for (int row = 0; row < out.rows; ++row)
    for (int column = 0; column < out.cols; ++column)
      if (bottom(row, column) > 0.05F) out(row, column) = top(row, column) / bottom(row, column);
  return out;
}

}  // namespace

DarkFit fit_dark_maps(const PictureStack& brief, const PictureStack& lasting) {
  if (brief.count() < kFewestDarks || lasting.count() < kFewestDarks)
    throw std::runtime_error("dark frames: " + std::to_string(std::min(brief.count(), lasting.count())) +
                             " at one of the exposures, at least " + std::to_string(kFewestDarks) + " are needed");
  const double apart_s = lasting.exposure_s() - brief.exposure_s();
  if (!(lasting.exposure_s() >= 4 * brief.exposure_s()) || lasting.iso() != brief.iso())
    throw std::runtime_error("dark frames: exposures of " + std::to_string(brief.exposure_s()) + " s and " +
                             std::to_string(lasting.exposure_s()) +
                             " s: take them at one ISO and a factor of 4 or more apart");
  const cv::Mat1f brief_mean = brief.mean_dn(), lasting_mean = lasting.mean_dn();
  const cv::Mat1f variance = brief.variance_dn2(), lasting_variance = lasting.variance_dn2();
  DarkFit fit;
  fit.noise_samples = static_cast<long>(brief.count() - 1) * static_cast<long>(variance.total());
  // The mean variance of all but the noisy pixels; a median of chi-squares would have to be corrected.
  const double typical = median(variance);
  const cv::Mat1b noisy(variance > 9 * typical);
  fit.noise_dn = std::sqrt(cv::mean(variance, ~noisy)[0]);
  fit.noise_sigma_dn = fit.noise_dn / std::sqrt(2.0 * static_cast<double>(fit.noise_samples));
  cv::Mat1f rate((lasting_mean - brief_mean) / apart_s);
  const double middle = median(rate);
  const cv::Mat1b hot(rate > middle + 5 * fit.noise_dn / apart_s);
  for (int row = 0; row < rate.rows; ++row)
    for (int column = 0; column < rate.cols; ++column) {
      const double variances = static_cast<double>(variance(row, column)) / brief.count() +
                               static_cast<double>(lasting_variance(row, column)) / lasting.count();
      const double sigma = std::sqrt(variances) / apart_s;
      if (std::abs(rate(row, column) - middle) < 5 * sigma) rate(row, column) = static_cast<float>(middle);
    }
  fit.maps.dark_dn_per_s = rate;
  fit.maps.bias_dn = brief_mean - rate * brief.exposure_s();
  fit.maps.bad = hot | noisy;
  fit.bad = {.hot = cv::countNonZero(hot), .noisy = cv::countNonZero(noisy & ~hot)};
  fit.bias_dn = cv::mean(fit.maps.bias_dn, ~fit.maps.bad)[0];
  fit.dark_dn_per_s = middle;
  return fit;
}

double dark_offset_dn(const SensorPicture& dark, const SensorMaps& maps) {
  if (maps.bias_dn.size() != dark.mosaic.size() || maps.dark_dn_per_s.size() != dark.mosaic.size())
    throw std::runtime_error("dark frame: it has another size than the sensor's maps: use the calibrated camera");
  std::vector<double> offsets;
  offsets.reserve(dark.mosaic.total());
  for (int row = 0; row < dark.mosaic.rows; ++row)
    for (int column = 0; column < dark.mosaic.cols; ++column)
      if (maps.bad.empty() || !maps.bad(row, column))
        offsets.push_back(dark.mosaic(row, column) - static_cast<double>(maps.bias_dn(row, column)) -
                          static_cast<double>(maps.dark_dn_per_s(row, column)) * dark.exposure_s);
  const auto cut = static_cast<std::ptrdiff_t>(offsets.size() / 1000);
  if (offsets.empty()) return 0.0;
  std::nth_element(offsets.begin(), offsets.begin() + cut, offsets.end());
  std::nth_element(offsets.begin() + cut, offsets.end() - cut - 1, offsets.end());
  return std::accumulate(offsets.begin() + cut, offsets.end() - cut, 0.0) /
         static_cast<double>(offsets.size() - 2 * static_cast<std::size_t>(cut));
}

FlatFit fit_flat_maps(const std::vector<PictureStack>& flats, double white_level_dn, SensorMaps& maps,
                      double smoothing_px) {
  if (flats.empty()) throw std::runtime_error("flat field: no picture of a white surface was given: take at least one");
  FlatFit fit;
  const cv::Size size = flats.front().mean_dn().size();
  if (maps.bias_dn.size() != size || maps.dark_dn_per_s.size() != size)
    throw std::runtime_error("flat field: needs dark maps of the pictures' size: take dark frames with this camera");
  if (maps.bad.empty()) maps.bad = cv::Mat1b(size, uchar{0});
  const std::vector<Planes> relative = relative_planes(white_signals(flats, white_level_dn, maps), maps.bad);
  const cv::Mat1b dead = dead_pixels(relative, size);
  fit.dead = cv::countNonZero(dead);
  maps.bad |= dead;

  // The relative values of all planes, summed on the sensor's own grid.
  cv::Mat1f sum(size, 0.0F), weight(size, 0.0F);
  double squares = 0;
  long pairs = 0;
  for (const Planes& planes : relative)
    for (int cell = 0; cell < kCells; ++cell) {
      const RelativePlane& plane = planes[static_cast<std::size_t>(cell)];
      for (int row = 0; row < plane.value.rows; ++row)
        for (int column = 0; column < plane.value.cols; ++column) {
          const int r = 2 * row + cell / 2, c = 2 * column + cell % 2;
          if (!plane.usable(row, column) || dead(r, c)) continue;
          sum(r, c) += plane.value(row, column);
          weight(r, c) += 1;
          if (column > 0 && plane.usable(row, column - 1)) {
            const double step = plane.value(row, column) - plane.value(row, column - 1);
            if (std::abs(step) < 0.25) squares += step * step, ++pairs;
          }
        }
    }
  maps.flat = smoothed(sum, weight, smoothing_px);
  fit.covered = cv::countNonZero(weight) / static_cast<double>(weight.total());
  // The noise of one site comes from the differences of neighbours; a Gaussian window averages over 4 pi sigma^2 sites.
  const double one = pairs > 0 ? std::sqrt(squares / static_cast<double>(pairs) / 2) : 0.0;
  fit.flat_noise =
      one / std::sqrt(4 * std::numbers::pi * smoothing_px * smoothing_px * static_cast<double>(flats.size()));
  double least = 1;
  cv::minMaxLoc(maps.flat, &least);
  fit.deepest = 1 - least;
  return fit;
}

}  // namespace calibration
