#include "calibration/sensor/photon_transfer.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calibration/sensor/sensor_range.h"

namespace calibration {
namespace {

constexpr double kBinRatio = 1.25;  // between the levels of neighbouring bins
constexpr int kFewestPixels = 300;  // in a bin
constexpr int kMostBins = 250, kNoBin = 255;
constexpr double kDimmestDn = 4.0;      // below it, errors of the dark level are too large a part of the signal
constexpr double kLinearTo = 0.85;      // part of the range up to which linearity_residual is taken
constexpr double kDarkErrorDn = 0.02;   // error of a bin's mean dark level
constexpr double kLeastScatter = 1e-4;  // relative scatter of a bin's mean that remains between good pictures
constexpr int kFewestExposures = 8;
constexpr double kRoundingDn2 = 1.0 / 12;

[[noreturn]] void refuse(const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("photon transfer: " + found + ": " + what_to_do);
}

double dark_at(const SensorPicture& picture, const SensorMaps& maps, int row, int column) {
  const double bias = maps.bias_dn.empty() ? picture.black_level_dn : static_cast<double>(maps.bias_dn(row, column));
  const double rate = maps.dark_dn_per_s.empty() ? 0.0 : static_cast<double>(maps.dark_dn_per_s(row, column));
  return bias + rate * picture.exposure_s;
}

bool is_bad(const SensorMaps& maps, int row, int column) {
  return !maps.bad.empty() && maps.bad(row, column) > 0;
}

void check(const SensorPicture& picture, const SensorMaps& maps) {
  for (const cv::Size size : {maps.bias_dn.size(), maps.dark_dn_per_s.size(), maps.bad.size()})
    if (size.area() > 0 && size != picture.mosaic.size())
      refuse("a map has another size than the picture", "take dark frames with this camera");
}

// The brightness of each pixel's neighbourhood in the same colour. It chooses the bin, so that the pixel's own noise
// does not.
cv::Mat1f neighbourhood(const SensorPicture& picture, const SensorMaps& maps) {
  cv::Mat1f signal(picture.mosaic.size());
  for (int row = 0; row < signal.rows; ++row)
    for (int column = 0; column < signal.cols; ++column)
      signal(row, column) = static_cast<float>(picture.mosaic(row, column) - dark_at(picture, maps, row, column));
  cv::Mat1f out(signal.size(), 0.0F);
  for (int cell = 0; cell < 4; ++cell) {
    cv::Mat1f plane((signal.rows - cell / 2 + 1) / 2, (signal.cols - cell % 2 + 1) / 2);
    for (int row = 0; row < plane.rows; ++row)
      for (int column = 0; column < plane.cols; ++column)
        plane(row, column) = signal(2 * row + cell / 2, 2 * column + cell % 2);
    cv::medianBlur(plane, plane, 3);  // removes bad pixels
    cv::GaussianBlur(plane, plane, {0, 0}, 1.5);
    for (int row = 0; row < plane.rows; ++row)
      for (int column = 0; column < plane.cols; ++column)
        out(2 * row + cell / 2, 2 * column + cell % 2) = plane(row, column);
  }
  return out;
}

struct Observation {
  int exposure, bin;
  double log_signal, level, sigma;
};

std::vector<Observation> observations(const std::vector<PairLevels>& ladder, double range_dn) {
  std::vector<Observation> all;
  for (std::size_t k = 0; k < ladder.size(); ++k)
    for (std::size_t b = 0; b < ladder[k].bins.size(); ++b) {
      const BinLevel& bin = ladder[k].bins[b];
      if (bin.pixels < kFewestPixels || bin.signal_dn < kDimmestDn) continue;
      const double noise = std::sqrt(bin.variance_dn2 / (2 * bin.pixels)) / bin.signal_dn;
      all.push_back({.exposure = static_cast<int>(k),
                     .bin = static_cast<int>(b),
                     .log_signal = std::log(bin.signal_dn),
                     .level = bin.signal_dn / range_dn,
                     .sigma = std::hypot(noise, kDarkErrorDn / bin.signal_dn, kLeastScatter)});
    }
  return all;
}

struct ShutterFit {
  std::vector<double> log_time, log_time_sigma;  // by exposure
  std::map<int, double> log_light;               // by bin
  double bend = 0, bend_sigma = 0, scatter = 0;
};

ShutterFit fit_shutter(const std::vector<Observation>& seen, const std::vector<PairLevels>& ladder,
                       std::size_t reference) {
  std::map<int, Eigen::Index> place;  // a bin's index among the unknowns
  const auto exposures = static_cast<Eigen::Index>(ladder.size());
  for (const Observation& o : seen) place.emplace(o.bin, 0);
  Eigen::Index unknowns = exposures + 1;  // log times (a strong prior keeps the reference's), then the bend
  for (auto& [bin, at] : place) at = unknowns++;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  const auto reference_at = static_cast<Eigen::Index>(reference);
  constexpr double kFixed = 1e14;
  normal(reference_at, reference_at) = kFixed;
  right(reference_at) = kFixed * std::log(ladder[reference].nominal_s);
  for (const Observation& o : seen) {
    const std::array<std::pair<Eigen::Index, double>, 3> row{
        {{o.exposure, 1.0}, {place.at(o.bin), 1.0}, {exposures, -o.level}}};
    const double weight = 1 / (o.sigma * o.sigma);
    for (const auto& [i, a] : row) {
      for (const auto& [j, b] : row) normal(i, j) += weight * a * b;
      right(i) += weight * a * o.log_signal;
    }
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
  const Eigen::VectorXd solution = solver.solve(right);
  const Eigen::MatrixXd inverse = solver.solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
  if (!solution.allFinite() || !inverse.allFinite() || !(inverse.diagonal().minCoeff() >= 0))
    refuse("the exposures do not overlap", "take pairs at whole stops, of a scene with bright and dim parts");
  ShutterFit fit;
  double chi2 = 0;
  for (const Observation& o : seen) {
    const double model = solution(o.exposure) + solution(place.at(o.bin)) - solution(exposures) * o.level;
    chi2 += std::pow((o.log_signal - model) / o.sigma, 2);
  }
  fit.scatter = chi2 / std::max(1.0, static_cast<double>(seen.size()) - static_cast<double>(unknowns - 1));
  const double widen = std::sqrt(std::max(1.0, fit.scatter));
  for (Eigen::Index k = 0; k < exposures; ++k) {
    fit.log_time.push_back(solution(k));
    fit.log_time_sigma.push_back(k == reference_at ? 0.0 : widen * std::sqrt(inverse(k, k)));
  }
  fit.bend = solution(exposures);
  fit.bend_sigma = widen * std::sqrt(inverse(exposures, exposures));
  for (const auto& [bin, at] : place) fit.log_light[bin] = solution(at);
  return fit;
}

// The mean deviation from the straight line, in steps of the level.
std::vector<LinearityPoint> linearity_of(const std::vector<Observation>& seen, const ShutterFit& fit) {
  constexpr int kSteps = 10;
  struct Sum {
    double weight = 0, level = 0, deviation = 0;
  };
  std::array<Sum, kSteps> sums;
  for (const Observation& o : seen) {
    if (o.level >= kLinearTo) continue;
    Sum& sum = sums.at(static_cast<std::size_t>(o.level / kLinearTo * kSteps));
    const double deviation =
        o.log_signal - fit.log_time[static_cast<std::size_t>(o.exposure)] - fit.log_light.at(o.bin);
    const double weight = 1 / (o.sigma * o.sigma);
    sum.weight += weight;
    sum.level += weight * o.level;
    sum.deviation += weight * deviation;
  }
  std::vector<LinearityPoint> points;
  for (const Sum& sum : sums)
    if (sum.weight > 0) points.push_back({sum.level / sum.weight, std::expm1(sum.deviation / sum.weight)});
  return points;
}

// Fits variance = gain * light + constant to the straightened response, with weights from the model itself.
void fit_gain(const std::vector<PairLevels>& ladder, const DarkFit& darks, double range_dn, PhotonTransfer& out) {
  struct Point {
    double light, variance, freedom;
  };
  std::vector<Point> points{{0.0, darks.noise_dn * darks.noise_dn, static_cast<double>(darks.noise_samples)}};
  const double q = out.response.nonlinearity;
  for (const PairLevels& pair : ladder)
    for (const BinLevel& bin : pair.bins) {
      if (bin.pixels < kFewestPixels) continue;
      out.transfer.push_back({bin.signal_dn, bin.variance_dn2});
      const double level = bin.signal_dn / range_dn;
      const double slope = std::exp(q * level) * (1 + q * level);
      points.push_back({range_dn * linear_signal(out.response, level),
                        (bin.variance_dn2 - kRoundingDn2) * slope * slope, bin.pixels});
    }
  points.front().variance -= kRoundingDn2;
  double gain = 0.1, constant = points.front().variance;
  Eigen::Matrix2d inverse;
  double scatter = 1;
  for (int pass = 0; pass < 8; ++pass) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double chi2 = 0;
    for (const Point& point : points) {
      const double expected = std::max(1e-3, gain * std::max(point.light, 0.0) + constant + kRoundingDn2);
      const double weight = point.freedom / (2 * expected * expected);
      const Eigen::Vector2d row(point.light, 1);
      normal += weight * row * row.transpose();
      right += weight * point.variance * row;
      chi2 += weight * std::pow(point.variance - gain * point.light - constant, 2);
    }
    inverse = normal.inverse();
    const Eigen::Vector2d solution = inverse * right;
    gain = solution(0);
    constant = solution(1);
    scatter = chi2 / static_cast<double>(points.size() - 2);
  }
  if (!(gain > 0) || !(constant > 0))
    refuse("the noise does not grow with the signal", "light the scene evenly and keep lamp and camera still");
  const double widen = std::max(1.0, scatter);
  out.response.gain_dn_per_e = gain;
  out.response.gain_sigma = std::sqrt(widen * inverse(0, 0));
  out.response.read_noise_e = std::sqrt(constant) / gain;
  const double constant_part = std::sqrt(widen * inverse(1, 1)) / (2 * constant);
  out.response.read_noise_sigma = out.response.read_noise_e * std::hypot(constant_part, out.response.gain_sigma / gain);
}

}  // namespace

LevelBins make_level_bins(const SensorPicture& reference, const SensorMaps& maps) {
  check(reference, maps);
  const double range = reference.white_level_dn - reference.black_level_dn;
  const cv::Mat1f brightness = neighbourhood(reference, maps);
  const double dimmest = 1e-3 * range;
  const int levels = static_cast<int>(std::ceil(std::log(range / dimmest) / std::log(kBinRatio)));
  std::map<int, int> pixels;  // key: cell and level
  cv::Mat1i keys(brightness.size(), -1);
  for (int row = 0; row < keys.rows; ++row)
    for (int column = 0; column < keys.cols; ++column) {
      const double value = brightness(row, column);
      if (is_bad(maps, row, column) || value < dimmest || value > range) continue;
      const int level = static_cast<int>(std::log(value / dimmest) / std::log(kBinRatio));
      const int key = (2 * (row % 2) + column % 2) * levels + level;
      keys(row, column) = key;
      ++pixels[key];
    }
  LevelBins bins{.bin = cv::Mat1b(keys.size(), static_cast<uchar>(kNoBin))};
  std::map<int, int> number;
  for (const auto& [key, count] : pixels)
    if (count >= kFewestPixels && bins.count < kMostBins) number[key] = bins.count++;
  if (bins.count < 4)
    refuse("the picture has too few pixels above " + std::to_string(dimmest) + " DN to make levels of",
           "light the white panel and meter the exposure");
  for (int row = 0; row < keys.rows; ++row)
    for (int column = 0; column < keys.cols; ++column)
      if (const auto found = number.find(keys(row, column)); found != number.end())
        bins.bin(row, column) = static_cast<uchar>(found->second);
  return bins;
}

PairLevels measure_pair(const SensorPicture& first, const SensorPicture& second, const LevelBins& bins,
                        const SensorMaps& maps, double apart_s) {
  check(first, maps);
  if (first.mosaic.size() != second.mosaic.size() || first.mosaic.size() != bins.bin.size())
    refuse("pictures of different sizes", "use one camera");
  if (std::abs(first.exposure_s - second.exposure_s) > 1e-3 * first.exposure_s || first.iso != second.iso)
    refuse("a pair with two exposures", "take both pictures of a pair alike");
  struct Sum {
    double pixels = 0, first = 0, second = 0, difference = 0, square = 0;
    bool saturated = false;
  };
  std::vector<Sum> sums(static_cast<std::size_t>(bins.count));
  const double limit = dn_at(first, kBrightest);
  const double ceiling = dn_at(first, kSaturated);
  double all_first = 0, all_second = 0;
  const auto visit = [&](auto&& take) {
    for (int row = 0; row < bins.bin.rows; ++row)
      for (int column = 0; column < bins.bin.cols; ++column) {
        const int bin = bins.bin(row, column);
        if (bin == kNoBin) continue;
        const double dark = dark_at(first, maps, row, column);
        take(sums[static_cast<std::size_t>(bin)], first.mosaic(row, column), second.mosaic(row, column), dark);
      }
  };
  visit([&](Sum& sum, double a, double b, double dark) {
    sum.saturated = sum.saturated || a > ceiling || b > ceiling;
    sum.pixels += 1;
    sum.first += a - dark;
    sum.second += b - dark;
  });
  for (Sum& sum : sums) {
    sum.saturated = sum.saturated || first.black_level_dn + sum.first / sum.pixels > limit;
    if (!sum.saturated) all_first += sum.first, all_second += sum.second;
  }
  // A lamp that changed between both pictures changed all pixels alike, which must not count as noise.
  const double ratio = all_first > 0 && all_second > 0 ? all_first / all_second : 1.0;
  visit([&](Sum& sum, double a, double b, double dark) {
    const double difference = (a - dark) - ratio * (b - dark);
    sum.difference += difference;
    sum.square += difference * difference;
  });
  PairLevels out{.nominal_s = first.exposure_s, .change = 1 / ratio - 1, .apart_s = apart_s};
  for (const Sum& sum : sums) {
    if (sum.saturated) {
      out.bins.push_back({});
      continue;
    }
    const double mean = sum.difference / sum.pixels;
    out.bins.push_back({.pixels = sum.pixels,
                        .signal_dn = (sum.first + sum.second) / (2 * sum.pixels),
                        .variance_dn2 = (sum.square / sum.pixels - mean * mean) * sum.pixels / (sum.pixels - 1) /
                                        (1 + ratio * ratio)});
  }
  return out;
}

PhotonTransfer fit_photon_transfer(const std::vector<PairLevels>& ladder, const DarkFit& darks, double range_dn,
                                   double reference_s) {
  std::vector<PairLevels> used = ladder;
  std::sort(used.begin(), used.end(), [](const auto& a, const auto& b) { return a.nominal_s < b.nominal_s; });
  std::erase_if(used, [](const PairLevels& pair) {
    return std::none_of(pair.bins.begin(), pair.bins.end(),
                        [](const BinLevel& bin) { return bin.pixels >= kFewestPixels && bin.signal_dn >= kDimmestDn; });
  });
  if (used.size() < kFewestExposures)
    refuse(std::to_string(used.size()) + " exposures with a measurable signal",
           "take pairs at " + std::to_string(kFewestExposures) + " exposures or more, a stop apart");
  const auto reference = std::find_if(used.begin(), used.end(), [&](const PairLevels& pair) {
    return std::abs(std::log2(pair.nominal_s / reference_s)) < 1.0 / 6;
  });
  if (reference == used.end())
    refuse("no pair at the reference time of " + std::to_string(reference_s) + " s", "take one");
  const std::vector<Observation> seen = observations(used, range_dn);
  const ShutterFit fit = fit_shutter(seen, used, static_cast<std::size_t>(reference - used.begin()));
  PhotonTransfer out;
  out.levels = static_cast<int>(used.size());
  out.scatter = fit.scatter;
  out.response.nonlinearity = fit.bend;
  out.response.nonlinearity_sigma = fit.bend_sigma;
  for (std::size_t k = 0; k < used.size(); ++k) {
    const double time_s = std::exp(fit.log_time[k]);
    out.response.shutter.push_back(
        {.nominal_s = used[k].nominal_s, .true_s = time_s, .sigma_s = time_s * fit.log_time_sigma[k]});
  }
  out.linearity = linearity_of(seen, fit);
  for (const LinearityPoint& point : out.linearity)
    out.linearity_residual = std::max(out.linearity_residual, std::abs(point.deviation));
  fit_gain(used, darks, range_dn, out);
  return out;
}

}  // namespace calibration
