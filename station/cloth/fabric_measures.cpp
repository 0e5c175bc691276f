#include "station/cloth/fabric_measures.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "calibration/sensor/median.h"
#include "station/bench/cloth_on_cylinder.h"

namespace station {
namespace {

using Eigen::Vector2d;

constexpr double kLeastFacing = 0.5;   // cosine between a pixel's ray and the cloth's normal
constexpr double kStandsOut = 25;      // power of a wave over that of the noise beside it
constexpr double kWindowWidens = 1.6;  // Hann's
constexpr int kMostOrder = 3;          // of waves in either direction
constexpr double kCellsPerRepeat = 10;
constexpr double kSmooth_repeats = 0.7;  // standard deviation of what changes slowly

struct Sample {
  Vector2d at_mm;  // around, along
  double value;
};

// A wave that was found, with the order that it has.
struct Wave {
  Vector2d order, frequency;  // 1/mm
  Vector2d sigma;
};

class Unrolled {
 public:
  Unrolled(const PhotographedCloth& cloth, const PeriodSearch& search) {
    const cv::Mat1f detail = detail_of(cloth, search);
    Vector2d low = Vector2d::Constant(1e9), high = -low;
    for (int row = 0; row < detail.rows; ++row)
      for (int column = 0; column < detail.cols; ++column) {
        if (cloth.mask(row, column) == 0) continue;
        const renderer::CameraRay ray = renderer::ray_through(cloth.camera, column, row);
        const auto point = side_point(ray, search.crown_radius_mm);
        if (!point) continue;
        const Eigen::Vector3d normal = Eigen::Vector3d(point->x(), point->y(), 0).normalized();
        if (-normal.dot(ray.direction) < kLeastFacing) continue;
        const Vector2d at(std::atan2(point->y(), point->x()) * search.middle_radius_mm, point->z());
        samples_.push_back({at, detail(row, column)});
        low = low.cwiseMin(at), high = high.cwiseMax(at);
      }
    if (empty()) return;
    extent_ = high - low;
    for (Sample& sample : samples_)
      for (int axis = 0; axis < 2; ++axis)
        sample.value *= std::pow(std::sin(std::numbers::pi * (sample.at_mm[axis] - low[axis]) / extent_[axis]), 2);
    gather(low, std::min(search.around_mm, search.along_mm) / kCellsPerRepeat);
  }

  bool empty() const { return samples_.size() < 100; }

  double power(const Vector2d& frequency) const {
    std::complex<double> sum = 0;
    for (const Sample& sample : samples_)
      sum += std::polar(sample.value, -2 * std::numbers::pi * frequency.dot(sample.at_mm));
    return std::norm(sum);
  }

  // The wave of this order that stands out most near where it is expected; nothing where none does.
  std::optional<Wave> wave(const Vector2d& order, const PeriodSearch& search) const {
    const Vector2d expected(order.x() / search.around_mm, order.y() / search.along_mm);
    // Bins of the spectrum, which are 1 / (size x cell) apart.
    Eigen::Vector2i middle, reach;
    const Vector2d bin(1 / (spectrum_.cols * cell_mm_), 1 / (spectrum_.rows * cell_mm_));
    for (int axis = 0; axis < 2; ++axis) {
      middle[axis] = static_cast<int>(std::lround(expected[axis] / bin[axis]));
      const double widest = std::max(search.within * std::abs(expected[axis]), 1 / extent_[axis]);
      reach[axis] = static_cast<int>(std::ceil(widest / bin[axis]));
    }
    std::vector<double> powers;
    Vector2d best = expected;
    double most = -1;
    for (int i = -reach.x(); i <= reach.x(); ++i)
      for (int j = -reach.y(); j <= reach.y(); ++j) {
        const int column = middle.x() + i, row = middle.y() + j;
        powers.push_back(
            spectrum_((row + spectrum_.rows) % spectrum_.rows, (column + spectrum_.cols) % spectrum_.cols));
        if (powers.back() > most) most = powers.back(), best = Vector2d(column * bin.x(), row * bin.y());
      }
    // The median of noise alone, whose power is exponentially distributed, is ln 2 of its mean.
    const double noise = calibration::median(std::move(powers)) / std::numbers::ln2;
    best = refined(best, bin);
    const double above = power(best) / noise;
    if (!(above > kStandsOut)) return std::nullopt;
    Wave found{.order = order, .frequency = best, .sigma = {}};
    for (int axis = 0; axis < 2; ++axis)
      found.sigma[axis] = kWindowWidens * std::sqrt(1.5 / above) / (std::numbers::pi * extent_[axis]);
    return found;
  }

 private:
  // Brightness over what it is nearby, less one.
  static cv::Mat1f detail_of(const PhotographedCloth& cloth, const PeriodSearch& search) {
    cv::Mat1f grey(cloth.image.size()), weight(cloth.image.size());
    for (int row = 0; row < grey.rows; ++row)
      for (int column = 0; column < grey.cols; ++column) {
        const cv::Vec3f& pixel = cloth.image(row, column);
        weight(row, column) = cloth.mask(row, column) ? 1 : 0;
        grey(row, column) = weight(row, column) * (pixel[0] + pixel[1] + pixel[2]);
      }
    const double distance_mm = cloth.camera.world_from_camera.translation().norm();
    const double smooth_px =
        kSmooth_repeats * std::max(search.around_mm, search.along_mm) * cloth.camera.fx / distance_mm;
    cv::Mat1f nearby, covered;
    cv::GaussianBlur(grey, nearby, {0, 0}, smooth_px);
    cv::GaussianBlur(weight, covered, {0, 0}, smooth_px);
    cv::Mat1f detail(grey.size(), 0.0f);
    for (int row = 0; row < grey.rows; ++row)
      for (int column = 0; column < grey.cols; ++column)
        if (cloth.mask(row, column) && nearby(row, column) > 0)
          detail(row, column) = grey(row, column) * covered(row, column) / nearby(row, column) - 1;
    return detail;
  }

  // The top of the parabola through the power's logarithm, axis by axis.
  Vector2d refined(Vector2d at, Vector2d step) const {
    for (int pass = 0; pass < 4; ++pass, step *= 0.5)
      for (int axis = 0; axis < 2; ++axis) {
        const Vector2d by = step[axis] * Vector2d::Unit(axis);
        const double before = std::log(power(at - by)), here = std::log(power(at)), after = std::log(power(at + by));
        const double bend = before - 2 * here + after;
        if (bend < 0) at += std::clamp(0.5 * (before - after) / bend, -1.0, 1.0) * by;
      }
    return at;
  }

  // Sums of the samples in cells, which stand for them from now on, and the power of the waves in these.
  void gather(const Vector2d& low, double cell_mm) {
    cell_mm_ = cell_mm;
    constexpr double kFiner = 2;  // bins than the extent has by itself
    const auto size = [&](double extent_mm) {
      return cv::getOptimalDFTSize(static_cast<int>(std::ceil(kFiner * extent_mm / cell_mm)) + 2);
    };
    cv::Mat1d cells(size(extent_.y()), size(extent_.x()), 0.0);
    for (const Sample& sample : samples_) {
      const Vector2d at = (sample.at_mm - low) / cell_mm;
      cells(static_cast<int>(at.y()), static_cast<int>(at.x())) += sample.value;
    }
    samples_.clear();
    for (int row = 0; row < cells.rows; ++row)
      for (int column = 0; column < cells.cols; ++column)
        if (cells(row, column) != 0)
          samples_.push_back({low + cell_mm * Vector2d(column + 0.5, row + 0.5), cells(row, column)});
    cv::Mat2d waves;
    cv::dft(cells, waves, cv::DFT_COMPLEX_OUTPUT);
    spectrum_.create(waves.size());
    for (int row = 0; row < waves.rows; ++row)
      for (int column = 0; column < waves.cols; ++column)
        spectrum_(row, column) = waves(row, column).dot(waves(row, column));
  }

  std::vector<Sample> samples_;
  Vector2d extent_ = Vector2d::Zero();
  double cell_mm_ = 0;
  cv::Mat1d spectrum_;  // power by the waves' frequency along (rows) and around (columns)
};

// One over the period by a wave of it.
MeasuredValue per_mm_of(const Wave& wave, int axis) {
  return {.value = wave.frequency[axis] / wave.order[axis], .sigma = wave.sigma[axis] / std::abs(wave.order[axis])};
}

// The mean of the waves that agree with the one that is known best: what stands out elsewhere is another wave's border.
std::optional<MeasuredValue> period_of(const std::vector<Wave>& waves, int axis, double scale_sigma) {
  constexpr double kAgree = 6;  // standard errors
  std::vector<MeasuredValue> all;
  for (const Wave& wave : waves)
    if (wave.order[axis] != 0) all.push_back(per_mm_of(wave, axis));
  if (all.empty()) return std::nullopt;
  const MeasuredValue best = *std::ranges::min_element(all, {}, &MeasuredValue::sigma);
  double weights = 0, sum = 0, chi2 = 0;
  int count = 0;
  for (const MeasuredValue& one : all) {
    const double off = one.value - best.value;
    if (std::abs(off) > kAgree * std::hypot(one.sigma, best.sigma)) continue;
    const double weight = 1 / (one.sigma * one.sigma);
    weights += weight, sum += weight * off, chi2 += weight * off * off, ++count;
  }
  const double per_mm = best.value + sum / weights;
  chi2 -= sum * sum / weights;
  // Where waves disagree by more than their errors, these are too small.
  const double larger = count > 1 ? std::max(1.0, std::sqrt(chi2 / (count - 1))) : 1.0;
  const double share = larger / std::sqrt(weights) / per_mm;
  return MeasuredValue{.value = 1 / per_mm, .sigma = std::hypot(share, scale_sigma) / per_mm};
}

}  // namespace

ClothPeriods measure_periods(const std::vector<PhotographedCloth>& pictures, const PeriodSearch& search) {
  std::vector<Wave> waves;
  for (const PhotographedCloth& picture : pictures) {
    const Unrolled cloth(picture, search);
    if (cloth.empty()) continue;
    for (int k = 0; k <= kMostOrder; ++k)
      for (int l = k == 0 ? 1 : -kMostOrder; l <= kMostOrder; ++l)
        if (const auto found = cloth.wave({k, l}, search)) waves.push_back(*found);
  }
  // What is seen lies between the crowns and the middle of the cloth.
  const double depth = (search.crown_radius_mm / search.middle_radius_mm - 1) / 2;
  return {.around_mm = period_of(waves, 0, std::hypot(search.scale_sigma, depth)),
          .along_mm = period_of(waves, 1, search.scale_sigma),
          .waves = static_cast<int>(waves.size())};
}

}  // namespace station
