#include "inversion/texture/texture_shading.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "renderer/scattering/random_stream.h"

namespace inversion {
namespace {

constexpr int kBandRows = 16;  // drawn together
constexpr int kReach = 16;     // rows around them that most of their paths stay in

// Value of a scattering event and its derivative by the absorption.
struct EventValue {
  Channels f, slope;
};

EventValue value_at(const TextureEvent& event, const Channels& sigma_a) {
  const Channels tt = event.tt * (sigma_a * -event.chord_tt).exp();
  const Channels trt = event.chord_trt == event.chord_tt && event.tt > 0
                           ? Channels(tt * (event.trt / event.tt))
                           : Channels(event.trt * (sigma_a * -event.chord_trt).exp());
  const Channels reflected(event.reflected[0], event.reflected[1], event.reflected[2], 0);
  return {reflected + tt + trt, -event.chord_tt * tt - event.chord_trt * trt};
}

int repeated(int place, int size) {
  while (place < 0) place += size;
  while (place >= size) place -= size;
  return place;
}

// One texel's paths shaded: the mean of their differences, and its derivatives by the unknowns that it depends on.
class ShadedTexel {
 public:
  ShadedTexel(const std::vector<TexelState>& texels, cv::Size size, bool slopes)
      : texels_(texels), size_(size), slopes_(slopes) {}

  void shade(const CrossingPaths& paths, std::size_t first, int count, int row, int column) {
    number_ = static_cast<std::size_t>(row) * static_cast<std::size_t>(size_.width) + static_cast<std::size_t>(column);
    difference_.setZero(), own_slope_.setZero();
    by_event_.clear();
    if (paths.count() == 0) return;
    const auto kept = static_cast<int>(paths.count());
    const int used = std::min(count, kept);
    const float share = static_cast<float>(kept) / static_cast<float>(paths.traced) / static_cast<float>(used);
    for (int i = 0; i < used; ++i)
      add_path(paths, (first + static_cast<std::size_t>(i)) % paths.count(), row, column, share);
    difference_ *= share;
    const TexelState& own = texels_[number_];
    own_slope_ = 1 + own_slope_ / own.curve_slope;
  }

  const Channels& difference() const { return difference_; }
  // dR / dx by the unknown of another texel that a path meets; own_slope() is that by the texel's own unknown.
  struct Slope {
    std::size_t texel;
    Channels slope;
  };
  const Channels& own_slope() const { return own_slope_; }
  const std::vector<Slope>& by_event() const { return by_event_; }

 private:
  void add_path(const CrossingPaths& paths, std::size_t path, int row, int column, float share) {
    constexpr float kTiny = 1e-20F;
    const Channels& own = texels_[number_].sigma_a;
    Channels value = Channels::Ones(), of_own = Channels::Ones(), own_log_slope = Channels::Zero(),
             at_home_log_slope = Channels::Zero();
    const std::size_t first = by_event_.size();
    for (std::uint32_t e = paths.ends[path]; e < paths.ends[path + 1]; ++e) {
      const TextureEvent& event = paths.events[e];
      const EventValue here = value_at(event, own);
      of_own *= here.f;
      const Channels here_log_slope = slopes_ ? Channels(here.slope / here.f.max(kTiny)) : Channels::Zero();
      own_log_slope += here_log_slope;
      if (event.right == 0 && event.up == 0) {
        value *= here.f;
        at_home_log_slope += here_log_slope;
        continue;
      }
      const auto texel =
          static_cast<std::size_t>(repeated(row - event.up, size_.height)) * static_cast<std::size_t>(size_.width) +
          static_cast<std::size_t>(repeated(column + event.right, size_.width));
      const EventValue there = value_at(event, texels_[texel].sigma_a);
      value *= there.f;
      if (slopes_) by_event_.push_back({texel, there.slope / there.f.max(kTiny) / texels_[texel].curve_slope});
    }
    difference_ += value - of_own;
    if (!slopes_) return;
    own_slope_ += share * (value * at_home_log_slope - of_own * own_log_slope);
    for (std::size_t i = first; i < by_event_.size(); ++i) by_event_[i].slope *= value * share;
  }

  const std::vector<TexelState>& texels_;
  cv::Size size_;
  bool slopes_;
  std::size_t number_ = 0;
  Channels difference_, own_slope_;
  std::vector<Slope> by_event_;
};

// Sums over the unknowns of a band's rows and those around it; what lies elsewhere is kept aside.
class BandSums {
 public:
  BandSums(int first_row, int end_row, cv::Size size)
      : first_(static_cast<std::size_t>(std::max(0, first_row - kReach)) * static_cast<std::size_t>(size.width)) {
    const std::size_t end =
        static_cast<std::size_t>(std::min(size.height, end_row + kReach)) * static_cast<std::size_t>(size.width);
    gradient_.assign(end - first_, Channels::Zero());
    steepness_ = gradient_;
  }

  void add(std::size_t texel, const Channels& gradient, const Channels& steepness) {
    if (texel < first_ || texel - first_ >= gradient_.size()) {
      elsewhere_.push_back({texel, gradient, steepness});
    } else {
      gradient_[texel - first_] += gradient;
      steepness_[texel - first_] += steepness;
    }
  }

  void add_to(TextureShading::Descent& sums) const {
    for (std::size_t i = 0; i < gradient_.size(); ++i) {
      sums.gradient[first_ + i] += gradient_[i];
      sums.steepness[first_ + i] += steepness_[i];
    }
    for (const Elsewhere& one : elsewhere_) {
      sums.gradient[one.texel] += one.gradient;
      sums.steepness[one.texel] += one.steepness;
    }
  }

 private:
  struct Elsewhere {
    std::size_t texel;
    Channels gradient, steepness;
  };
  std::size_t first_;
  std::vector<Channels> gradient_, steepness_;
  std::vector<Elsewhere> elsewhere_;
};

std::vector<cv::Range> bands_of(int rows) {
  std::vector<cv::Range> bands;
  for (int row = 0; row < rows; row += kBandRows) bands.emplace_back(row, std::min(row + kBandRows, rows));
  return bands;
}

}  // namespace

Channels uniform_value(const CrossingPaths& paths, float sigma_a) {
  const Channels everywhere = Channels::Constant(sigma_a);
  Eigen::Array4d sum = Eigen::Array4d::Zero();
  for (std::size_t i = 0; i < paths.count(); ++i) {
    Channels value = Channels::Ones();
    for (std::uint32_t e = paths.ends[i]; e < paths.ends[i + 1]; ++e) value *= value_at(paths.events[e], everywhere).f;
    sum += value.cast<double>();
  }
  return (sum / paths.traced).cast<float>();
}

std::size_t TextureShading::crossing(int row, int column) const {
  const int from_below = (size_.height - 1 - row) % crossings_.y();
  return static_cast<std::size_t>((crossings_.y() - 1 - from_below) * crossings_.x() + column % crossings_.x());
}

TextureShading::Draw TextureShading::drawn(int row, int column, std::uint64_t draw) const {
  const CrossingPaths& paths = mixing_[crossing(row, column)];
  const auto number =
      static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(size_.width) + static_cast<std::uint64_t>(column);
  const std::uint64_t random = renderer::mixed_bits(draw + renderer::mixed_bits(number));
  return {paths, paths.count() > 0 ? static_cast<std::size_t>(random % paths.count()) : 0};
}

cv::Mat3f TextureShading::reflectance(const std::vector<TexelState>& texels, int paths, std::uint64_t draw) const {
  cv::Mat3f shown(size_);
  tbb::parallel_for(0, size_.height, [&](int row) {
    ShadedTexel shaded(texels, size_, false);
    for (int column = 0; column < size_.width; ++column) {
      const Draw of = drawn(row, column, draw);
      shaded.shade(of.paths, of.first, paths, row, column);
      const Channels found =
          texels[static_cast<std::size_t>(row * size_.width + column)].curve_reflectance + shaded.difference();
      shown(row, column) = {found[0], found[1], found[2]};
    }
  });
  return shown;
}

TextureShading::Descent TextureShading::descent(const std::vector<TexelState>& texels, const cv::Mat3f& target,
                                                const std::vector<Channels>& weights, int paths,
                                                std::uint64_t draw) const {
  const std::vector<cv::Range> bands = bands_of(size_.height);
  std::vector<BandSums> sums;
  for (const cv::Range& band : bands) sums.emplace_back(band.start, band.end, size_);
  std::vector<double> losses(bands.size());
  tbb::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t b) {
    ShadedTexel shaded(texels, size_, true);
    for (int row = bands[b].start; row < bands[b].end; ++row)
      for (int column = 0; column < size_.width; ++column) {
        const Draw of = drawn(row, column, draw);
        shaded.shade(of.paths, of.first, paths, row, column);
        const auto p = static_cast<std::size_t>(row * size_.width + column);
        const cv::Vec3f& wanted = target(row, column);
        const Channels residual =
            texels[p].curve_reflectance + shaded.difference() - Channels(wanted[0], wanted[1], wanted[2], 0);
        const Channels w = weights[p];
        Channels row_sum = shaded.own_slope().abs();
        for (const ShadedTexel::Slope& one : shaded.by_event()) row_sum += one.slope.abs();
        losses[b] += static_cast<double>((w * residual.square()).head<3>().sum());
        sums[b].add(p, w * residual * shaded.own_slope(), w * shaded.own_slope().abs() * row_sum);
        for (const ShadedTexel::Slope& one : shaded.by_event())
          sums[b].add(one.texel, w * residual * one.slope, w * one.slope.abs() * row_sum);
      }
  });
  Descent all{.gradient = std::vector<Channels>(texels.size(), Channels::Zero()),
              .steepness = std::vector<Channels>(texels.size(), Channels::Zero())};
  for (std::size_t b = 0; b < bands.size(); ++b) {
    sums[b].add_to(all);
    all.loss += losses[b];
  }
  return all;
}

}  // namespace inversion
