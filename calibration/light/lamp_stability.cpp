#include "calibration/light/lamp_stability.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "calibration/sensor/sensor_range.h"

namespace calibration {
namespace {

constexpr int kFewestRapid = 10;

// The sum of the signal over all binned pixels.
double signal_of(const SensorPicture& picture, const LevelBins& bins, const SensorMaps& maps) {
  double sum = 0;
  const double ceiling = dn_at(picture, kSaturated);
  for (int row = 0; row < bins.bin.rows; ++row)
    for (int column = 0; column < bins.bin.cols; ++column) {
      if (bins.bin(row, column) >= bins.count) continue;
      const double value = picture.mosaic(row, column);
      if (value > ceiling)
        throw std::runtime_error("lamp: a picture of the flicker test is saturated: take it with a shorter exposure");
      const double bias =
          maps.bias_dn.empty() ? picture.black_level_dn : static_cast<double>(maps.bias_dn(row, column));
      const double rate = maps.dark_dn_per_s.empty() ? 0.0 : static_cast<double>(maps.dark_dn_per_s(row, column));
      sum += value - bias - rate * picture.exposure_s;
    }
  return sum;
}

std::string percent(double value) {
  std::string text = std::to_string(std::round(value * 1e5) / 1e3);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " %";
}

}  // namespace

LampStability lamp_stability(const std::vector<SensorPicture>& rapid, const LevelBins& bins, const SensorMaps& maps,
                             const std::vector<PairLevels>& pairs) {
  if (rapid.size() < kFewestRapid)
    throw std::runtime_error("lamp: " + std::to_string(rapid.size()) + " rapid pictures, " +
                             std::to_string(kFewestRapid) + " are needed to see flicker");
  std::vector<double> logs;
  for (const SensorPicture& picture : rapid) {
    const double sum = signal_of(picture, bins, maps);
    if (!(sum > 0)) throw std::runtime_error("lamp: a picture of the flicker test is dark: switch the lamp on");
    logs.push_back(std::log(sum));
  }
  // Flicker is the standard deviation about a straight line in the pictures' order.
  const double count = static_cast<double>(logs.size());
  double mean = 0, mean_index = (count - 1) / 2, cross = 0, square = 0;
  for (const double value : logs) mean += value / count;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    cross += (static_cast<double>(i) - mean_index) * (logs[i] - mean);
    square += std::pow(static_cast<double>(i) - mean_index, 2);
  }
  double residual = 0;
  for (std::size_t i = 0; i < logs.size(); ++i)
    residual += std::pow(logs[i] - mean - cross / square * (static_cast<double>(i) - mean_index), 2);
  LampStability out;
  out.flicker = std::sqrt(residual / (count - 2));

  // All pairs get one scatter, because a pair's change scatters by about the flicker whatever time lies between.
  double change_by_time = 0, times = 0;
  for (const PairLevels& pair : pairs) {
    change_by_time += pair.change * pair.apart_s;
    times += pair.apart_s * pair.apart_s;
  }
  if (times > 0) {
    const double per_s = change_by_time / times;
    double left = 0;
    for (const PairLevels& pair : pairs) left += std::pow(pair.change - per_s * pair.apart_s, 2);
    const double scatter = std::sqrt(left / std::max<double>(1, static_cast<double>(pairs.size()) - 1));
    out.drift_per_min = 60 * per_s;
    out.drift_sigma_per_min = 60 * scatter / std::sqrt(times);
  }
  return out;
}

std::vector<Gate> lamp_gates(const std::vector<double>& strength, const LampGates& limits) {
  double jump = 0, change = 0;
  for (std::size_t i = 1; i < strength.size(); ++i) {
    jump = std::max(jump, std::abs(strength[i] / strength[i - 1] - 1));
    change = std::max(change, std::abs(strength[i] / strength[0] - 1));
  }
  Gate step{.name = "lamp jump", .value = jump, .limit = limits.largest_jump, .passed = jump <= limits.largest_jump};
  step.reason = "the lamp changed by " + percent(jump) + " from one picture to the next" +
                (step.passed ? "; each picture is divided by its own strength" : "; let it warm up and take it again");
  Gate total{.name = "lamp change",
             .value = change,
             .limit = limits.largest_change,
             .passed = change <= limits.largest_change};
  total.reason = "the lamp changed by " + percent(change) + " in all" +
                 (total.passed ? "; each picture is divided by its own strength"
                               : "; replace or cool it, calibrate again and take the pictures again");
  return {step, total};
}

}  // namespace calibration
