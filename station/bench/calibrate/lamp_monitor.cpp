#include "station/bench/calibrate/lamp_monitor.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>

#include "calibration/develop/polygon_mask.h"

namespace station {
namespace {

constexpr double kLampRange = 0.03;   // by which a lamp in use changes between the pictures
constexpr double kAgreement = 0.004;  // between tags that see the same lamp; the edge of a shadow takes any part
constexpr std::size_t kFewestTags = 3, kFewestPictures = 3;

// The largest group of values whose range is this part of them, sorted.
std::vector<double> largest_group(std::vector<double> values, double range) {
  std::sort(values.begin(), values.end());
  std::size_t best = 0, begin = 0;
  for (std::size_t first = 0; first < values.size(); ++first) {
    std::size_t count = 0;
    while (first + count < values.size() && values[first + count] <= values[first] * (1 + range)) ++count;
    if (count > best) best = count, begin = first;
  }
  const auto from = values.begin() + static_cast<std::ptrdiff_t>(begin);
  return {from, from + static_cast<std::ptrdiff_t>(best)};
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// The brightness of each tag under the typical lamp: where it lies in the open it looks alike in many pictures.
std::map<int, double> lit_brightness(const std::vector<std::map<int, double>>& pictures,
                                     const std::vector<std::optional<double>>& outputs) {
  std::map<int, std::vector<double>> seen;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    for (const auto& [id, radiance] : pictures[i])
      if (radiance > 0) seen[id].push_back(radiance / outputs[i].value_or(1.0));
  std::map<int, double> lit;
  for (const auto& [id, radiances] : seen) {
    const std::vector<double> open = largest_group(radiances, kLampRange);
    if (open.size() >= kFewestPictures) lit[id] = open[open.size() / 2];
  }
  return lit;
}

std::vector<std::optional<double>> outputs_under(const std::vector<std::map<int, double>>& pictures,
                                                 const std::map<int, double>& lit) {
  std::vector<std::optional<double>> outputs;
  for (const auto& picture : pictures) {
    std::vector<double> ratios;
    for (const auto& [id, radiance] : picture)
      if (lit.contains(id) && std::abs(radiance / lit.at(id) - 1) < kLampRange) ratios.push_back(radiance / lit.at(id));
    const std::vector<double> agreed = largest_group(ratios, kAgreement);
    outputs.push_back(agreed.size() < kFewestTags ? std::nullopt : std::optional(mean(agreed)));
  }
  return outputs;
}

}  // namespace

std::map<int, double> tag_radiances(const calibration::Developed& picture, const calibration::StillTags& tags) {
  std::map<int, double> radiances;
  for (const auto& [id, corners] : tags) {
    const cv::Mat1b inside = calibration::polygon_mask(picture.radiance.size(), corners);
    if (cv::countNonZero(inside) == 0 || cv::countNonZero(inside & picture.saturated) > 0) continue;
    const cv::Scalar mean = cv::mean(picture.radiance, inside);
    radiances[id] = mean[0] + mean[1] + mean[2];
  }
  return radiances;
}

std::vector<std::optional<double>> lamp_outputs(const std::vector<std::map<int, double>>& pictures) {
  std::vector<std::optional<double>> outputs(pictures.size(), 1.0);
  // Tags lie in the open in different pictures: what each looks like under the typical lamp is told by the outputs.
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) outputs = outputs_under(pictures, lit_brightness(pictures, outputs));
  return outputs;
}

}  // namespace station
