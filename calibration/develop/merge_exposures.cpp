#include "calibration/develop/merge_exposures.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "calibration/sensor/developable.h"
#include "calibration/sensor/sensor_range.h"
#include "calibration/sensor/size_text.h"

namespace calibration {
namespace {

struct Exposure {
  const SensorPicture* raw;
  double time_s;
  cv::Mat1b beside_saturated;
};

std::vector<Exposure> by_time(const std::vector<SensorPicture>& bracket, const SensorResponse& response) {
  std::vector<Exposure> exposures;
  for (const SensorPicture& raw : bracket) {
    cv::Mat1b saturated(raw.mosaic > dn_at(raw, kSaturated));
    cv::dilate(saturated, saturated, cv::Mat1b::ones(3, 3));
    exposures.push_back({&raw, true_exposure_s(response, raw.exposure_s), saturated});
  }
  std::sort(exposures.begin(), exposures.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  return exposures;
}

}  // namespace

void require_developable(const SensorPicture& raw) {
  if (raw.mosaic.rows < 2 || raw.mosaic.cols < 2) throw std::runtime_error("develop: the raw picture has no pixels");
  if (!(raw.white_level_dn > raw.black_level_dn) || !(raw.exposure_s > 0.0))
    throw std::runtime_error("develop: needs a white level above the black level and an exposure time, found black " +
                             std::to_string(raw.black_level_dn) + ", white " + std::to_string(raw.white_level_dn) +
                             ", exposure " + std::to_string(raw.exposure_s) + " s: check the raw file");
  for (const int channel : raw.channel)
    if (channel < 0 || channel > 2)
      throw std::runtime_error("develop: colour " + std::to_string(channel) +
                               " in the mosaic, only red, green and blue are known");
}

void require_mergeable(const std::vector<SensorPicture>& bracket, const SensorResponse& response) {
  if (bracket.empty()) throw std::runtime_error("develop: no picture was given");
  const SensorPicture& first = bracket.front();
  for (const SensorPicture& raw : bracket) {
    require_developable(raw);
    if (raw.mosaic.size() != first.mosaic.size() || raw.iso != first.iso || raw.channel != first.channel ||
        raw.black_level_dn != first.black_level_dn || raw.white_level_dn != first.white_level_dn) {
      throw std::runtime_error(
          "develop: the exposures of a bracket differ in size, ISO or levels: take them with one camera, changing "
          "the "
          "shutter time alone");
    }
  }
  const cv::Size size = first.mosaic.size();
  for (const cv::Size& map : {response.maps.bias_dn.size(), response.maps.dark_dn_per_s.size(),
                              response.maps.flat.size(), response.maps.bad.size()}) {
    if (map.area() > 0 && map != size) {
      throw std::runtime_error("develop: a dark, flat or bad-pixel map is " + size_text(map) + " px, the picture " +
                               size_text(size) + ": take dark frames and calibrate with the same camera");
    }
  }
}

LinearMosaic merge_exposures(const std::vector<SensorPicture>& bracket, const SensorResponse& response,
                             double dark_offset_dn) {
  require_mergeable(bracket, response);
  const std::vector<Exposure> exposures = by_time(bracket, response);
  const SensorPicture& first = bracket.front();
  const double range = first.white_level_dn - first.black_level_dn;
  const double gain = response.gain_dn_per_e / range;  // part of the range per electron
  const double read_variance = std::pow(gain * response.read_noise_e, 2);
  LinearMosaic out{.radiance = cv::Mat1f(first.mosaic.size()),
                   .variance = gain > 0 ? cv::Mat1f(first.mosaic.size()) : cv::Mat1f(),
                   .saturated = cv::Mat1b(first.mosaic.size(), uchar{0}),
                   .channel = first.channel};
  const SensorMaps& maps = response.maps;
  const auto merge_row = [&](int row) {
    for (int column = 0; column < out.radiance.cols; ++column) {
      const double bias =
          (maps.bias_dn.empty() ? first.black_level_dn : static_cast<double>(maps.bias_dn(row, column))) +
          dark_offset_dn;
      const double dark_rate = maps.dark_dn_per_s.empty() ? 0.0 : static_cast<double>(maps.dark_dn_per_s(row, column));
      const auto light_of = [&](const Exposure& exposure) {
        const double dark = bias + dark_rate * exposure.raw->exposure_s;
        return linear_signal(response, (exposure.raw->mosaic(row, column) - dark) / range);
      };
      const auto usable = [&](const Exposure& exposure) {
        return !exposure.beside_saturated(row, column) && exposure.raw->mosaic(row, column) < dn_at(first, kBrightest);
      };
      double light = 0, time_s = 0;
      for (const Exposure& exposure : exposures)
        if (usable(exposure)) light += light_of(exposure), time_s += exposure.time_s;
      double radiance = 0, information = 0;
      if (time_s > 0) {
        const double mean = std::max(light / time_s, 0.0);
        double weighted = 0;
        for (const Exposure& exposure : exposures) {
          if (!usable(exposure)) continue;
          const double variance = gain > 0 ? gain * mean * exposure.time_s + read_variance : exposure.time_s;
          information += exposure.time_s * exposure.time_s / variance;
          weighted += exposure.time_s * light_of(exposure) / variance;
        }
        radiance = weighted / information;
      } else {
        const Exposure& shortest = exposures.front();
        const double value = light_of(shortest);
        radiance = value / shortest.time_s;
        information = gain > 0 ? shortest.time_s * shortest.time_s / (gain * std::max(value, 0.0) + read_variance) : 1;
        if (shortest.raw->mosaic(row, column) > dn_at(first, kSaturated)) out.saturated(row, column) = 255;
      }
      const double flat = maps.flat.empty() ? 1.0 : static_cast<double>(maps.flat(row, column));
      out.radiance(row, column) = static_cast<float>(radiance / flat);
      if (gain > 0) out.variance(row, column) = static_cast<float>(1 / (information * flat * flat));
    }
  };
  cv::parallel_for_({0, out.radiance.rows}, [&](const cv::Range& rows) {
    for (int row = rows.start; row < rows.end; ++row) merge_row(row);
  });
  if (!maps.bad.empty()) repair_bad_pixels(maps.bad, out);
  return out;
}

void repair_bad_pixels(const cv::Mat1b& bad, LinearMosaic& mosaic) {
  const cv::Rect frame(0, 0, bad.cols, bad.rows);
  const auto good = [&](const cv::Point& p) { return frame.contains(p) && !bad(p); };
  for (int row = 0; row < bad.rows; ++row)
    for (int column = 0; column < bad.cols; ++column) {
      if (!bad(row, column)) continue;
      const cv::Point here(column, row);
      std::vector<cv::Point> steps{{2, 0}, {0, 2}, {2, 2}, {2, -2}};
      const auto cell = [&](int r, int c) { return static_cast<std::size_t>(2 * (r % 2) + c % 2); };
      if (mosaic.channel[cell(row, column)] == mosaic.channel[cell(row + 1, column + 1)])
        steps.insert(steps.end(), {{1, 1}, {1, -1}});
      double weights = 0, radiance = 0, variance = 0;
      uchar saturated = 0;
      const auto take = [&](const cv::Point& p, double weight) {
        weights += weight;
        radiance += weight * mosaic.radiance(p);
        if (!mosaic.variance.empty()) variance += weight * mosaic.variance(p);
        saturated |= mosaic.saturated(p);
      };
      for (const cv::Point& step : steps) {
        if (!good(here + step) || !good(here - step)) continue;
        const double weight = 1.0 / step.dot(step);
        take(here + step, weight);
        take(here - step, weight);
      }
      if (weights == 0)
        for (const cv::Point& step : steps)
          for (const cv::Point& p : {here + step, here - step})
            if (good(p)) take(p, 1.0 / step.dot(step));
      mosaic.saturated(here) = weights > 0 ? saturated : uchar{255};
      if (weights == 0) continue;
      mosaic.radiance(here) = static_cast<float>(radiance / weights);
      // The neighbours' noise counts again in pixels that are demosaiced from this one and from them, so this variance
      // is not taken below one neighbour's.
      if (!mosaic.variance.empty()) mosaic.variance(here) = static_cast<float>(variance / weights);
    }
}

}  // namespace calibration
