#include "renderer/picture/denoise.h"

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace renderer {
namespace {

using Planes = std::vector<cv::Mat1f>;

constexpr int kMostFeatures = 12;
constexpr int kRadius = 2;         // of the windows, which are 5 x 5 blocks of pixels
constexpr int kLevels = 3;         // blocks of 1, 2 and 4 pixels along a side
constexpr int kTaming = 1;         // the level whose fit outliers are measured from
constexpr int kJudged_px = 8;      // radius of the windows in which errors are compared
constexpr int kBlended_px = 3;     // and of those over which the choice is smoothed
constexpr int kTogether_px = 256;  // side of what is worked on at once; a multiple of the largest block
constexpr int kHalo_px = 32;  // that is seen around it: as far as two of the largest windows and a judged one reach
constexpr int kLargestBlock_px = 1 << (kLevels - 1);
static_assert(kHalo_px >= (2 * kRadius + 1) * kLargestBlock_px + kJudged_px + kBlended_px);

cv::Mat1f plane_of(const cv::Mat& expression) {
  return expression;
}

cv::Mat1f mean_around(const cv::Mat& plane, int radius) {
  cv::Mat1f mean;
  cv::boxFilter(plane, mean, CV_32F, {2 * radius + 1, 2 * radius + 1}, {-1, -1}, true, cv::BORDER_REFLECT);
  return mean;
}

// Means of 2 x 2 blocks.
cv::Mat1f halved(const cv::Mat1f& plane) {
  cv::Mat1f small;
  cv::resize(plane, small, {plane.cols / 2, plane.rows / 2}, 0, 0, cv::INTER_AREA);
  return small;
}

// Without mean and with a spread of 1, so that one ridge serves all; a plane that is the same everywhere tells nothing.
Planes standardized(const Planes& features) {
  constexpr double kConstant = 1e-6;
  Planes kept;
  for (const cv::Mat1f& feature : features) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(feature, mean, deviation);
    if (deviation[0] > kConstant * (1 + std::abs(mean[0])))
      kept.push_back(plane_of((feature - mean[0]) / deviation[0]));
  }
  return kept;
}

// Column and row as features, from the region's middle.
Planes places(const cv::Size& size) {
  constexpr float kUnit_px = 3;
  Planes planes(2);
  planes[0].create(size), planes[1].create(size);
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      planes[0](row, column) = (static_cast<float>(column) - static_cast<float>(size.width) / 2) / kUnit_px;
      planes[1](row, column) = (static_cast<float>(row) - static_cast<float>(size.height) / 2) / kUnit_px;
    }
  return planes;
}

struct Smoothed {
  Planes colours;      // RGB
  cv::Mat1f leverage;  // how much of a pixel's own noise is left in it, 0 to 1
};

// The colours as linear functions of the features, fitted by least squares with a ridge over the window around each
// block; a pixel's value is the mean of what the windows say that it lies in.
class LinearFits {
 public:
  // Neighbouring blocks are solved together, so that a processor does the same for several at once.
  static constexpr int kLanes = 8, kLeastSide_px = kLanes * kLargestBlock_px;

  // The regions' sides are multiples of the largest block, and kLeastSide_px or more.
  explicit LinearFits(const Planes& features) : features_(features), count_(static_cast<int>(features.size())) {
    Planes means = features, products;
    for (int i = 0; i < count_; ++i)
      for (int j = 0; j <= i; ++j) products.push_back(plane_of(features[i].mul(features[j])));
    for (int level = 0; level < kLevels; ++level) {
      if (level > 0)
        for (Planes* planes : {&means, &products})
          for (cv::Mat1f& plane : *planes) plane = halved(plane);
      for (const cv::Mat1f& plane : means) levels_[level].means.push_back(mean_around(plane, kRadius));
      for (const cv::Mat1f& plane : products) levels_[level].products.push_back(mean_around(plane, kRadius));
    }
  }

  Smoothed fit(const Planes& colours, int level) const {
    Planes means, moments;
    for (const cv::Mat1f& colour : colours) means.push_back(at_level(colour, level));
    for (const cv::Mat1f& feature : features_)
      for (const cv::Mat1f& colour : colours) moments.push_back(at_level(plane_of(feature.mul(colour)), level));
    const cv::Size coarse = means[0].size();
    Planes slopes(3 * count_), offsets(3);
    for (Planes* planes : {&slopes, &offsets})
      for (cv::Mat1f& plane : *planes) plane.create(coarse);
    cv::Mat1f leverage(coarse);
    for (int row = 0; row < coarse.height; ++row)
      for (int column = 0; column < coarse.width; column += kLanes)
        solve(level, row, std::min(column, coarse.width - kLanes), means, moments, slopes, offsets, leverage);
    Smoothed result{.colours = Planes(3), .leverage = everywhere(leverage)};
    for (int c = 0; c < 3; ++c) {
      result.colours[c] = everywhere(offsets[c]);
      for (int i = 0; i < count_; ++i) {
        const cv::Mat1f part = plane_of(everywhere(slopes[3 * i + c]).mul(features_[i]));
        result.colours[c] += part;
      }
    }
    return result;
  }

 private:
  using Lanes = Eigen::Array<float, kLanes, 1>;
  struct Level {
    Planes means, products;  // the latter: the lower triangle by rows
  };

  static cv::Mat1f at_level(cv::Mat1f plane, int level) {
    for (int i = 0; i < level; ++i) plane = halved(plane);
    return mean_around(plane, kRadius);
  }

  // The mean over windows in which a pixel lies, also between the middles of blocks.
  cv::Mat1f everywhere(const cv::Mat1f& plane) const {
    const bool blocks = plane.size() != features_[0].size();
    cv::Mat1f fine = mean_around(plane, blocks ? kRadius - 1 : kRadius);
    if (blocks) cv::resize(cv::Mat1f(fine), fine, features_[0].size(), 0, 0, cv::INTER_LINEAR);
    return fine;
  }

  // By Cholesky's decomposition of the features' covariance.
  void solve(int level, int row, int column, const Planes& colour_means, const Planes& moments, Planes& slopes,
             Planes& offsets, cv::Mat1f& leverage) const {
    constexpr float kRidge = 1e-3f;  // of standardized features
    const auto read = [&](const cv::Mat1f& plane) {
      return Lanes(Eigen::Map<const Lanes>(plane.ptr<float>(row) + column));
    };
    const auto write = [&](const Lanes& values, cv::Mat1f& plane) {
      Eigen::Map<Lanes>(plane.ptr<float>(row) + column) = values;
    };
    const Level& here = levels_[level];
    std::array<Lanes, kMostFeatures> mean;
    std::array<std::array<Lanes, kMostFeatures>, kMostFeatures> factor;  // lower triangle; inverse diagonal
    std::array<std::array<Lanes, kMostFeatures>, 3> slope;
    std::array<Lanes, 3> colour_mean;
    for (int c = 0; c < 3; ++c) colour_mean[c] = read(colour_means[c]);
    for (int i = 0, k = 0; i < count_; ++i) {
      mean[i] = read(here.means[i]);
      for (int j = 0; j <= i; ++j, ++k) {
        Lanes left = read(here.products[k]) - mean[i] * mean[j];
        for (int m = 0; m < j; ++m) left -= factor[i][m] * factor[j][m];
        factor[i][j] = j < i ? Lanes(left * factor[j][j]) : Lanes((left + kRidge).max(kRidge).rsqrt());
      }
      for (int c = 0; c < 3; ++c) {
        Lanes left = read(moments[3 * i + c]) - mean[i] * colour_mean[c];
        for (int m = 0; m < i; ++m) left -= factor[i][m] * slope[c][m];
        slope[c][i] = left * factor[i][i];
      }
    }
    // Of the window's pixels on average: one and the trace of the smoothing matrix, over their number.
    Lanes freedom = Lanes::Constant(1.0f + static_cast<float>(count_));
    for (int j = 0; j < count_; ++j) {  // column of the factor's inverse
      std::array<Lanes, kMostFeatures> inverse;
      for (int i = j; i < count_; ++i) {
        Lanes left = Lanes::Constant(i == j ? 1.0f : 0.0f);
        for (int m = j; m < i; ++m) left -= factor[i][m] * inverse[m];
        inverse[i] = left * factor[i][i];
        freedom -= kRidge * inverse[i].square();
      }
    }
    const int window_px = (2 * kRadius + 1) << level;
    write((freedom / static_cast<float>(window_px * window_px)).min(1.0f), leverage);
    for (int c = 0; c < 3; ++c) {
      for (int i = count_ - 1; i >= 0; --i) {
        for (int m = i + 1; m < count_; ++m) slope[c][i] -= factor[m][i] * slope[c][m];
        slope[c][i] *= factor[i][i];
        colour_mean[c] -= slope[c][i] * mean[i];
        write(slope[c][i], slopes[3 * i + c]);
      }
      write(colour_mean[c], offsets[c]);
    }
  }

  const Planes& features_;
  int count_;
  std::array<Level, kLevels> levels_{};
};

cv::Mat1f squared_difference(const Planes& a, const Planes& b) {
  cv::Mat1f sum(a[0].size(), 0.0f);
  for (int c = 0; c < 3; ++c) {
    const cv::Mat1f difference = plane_of(a[c] - b[c]);
    sum += difference.mul(difference);
  }
  return sum;
}

// Single pixels that stand out by far would be smeared over their windows: what is more than kMost usual deviations
// from `smooth`, and farther than each of its neighbours, is brought back to that. A highlight is no single pixel.
Planes without_outliers(const Planes& colours, const Planes& smooth) {
  constexpr float kMost = 2.5;
  const cv::Mat1f squares = squared_difference(colours, smooth);
  const cv::Mat1f usual = mean_around(squares, (2 * kRadius + 1));
  cv::Mat1f of_neighbours;
  const cv::Mat1b ring = (cv::Mat1b(3, 3) << 1, 1, 1, 1, 0, 1, 1, 1, 1);
  cv::dilate(squares, of_neighbours, ring);
  Planes tame{colours[0].clone(), colours[1].clone(), colours[2].clone()};
  for (int row = 0; row < squares.rows; ++row)
    for (int column = 0; column < squares.cols; ++column) {
      const float most = std::max(kMost * kMost * usual(row, column), of_neighbours(row, column));
      if (!(most > 0 && squares(row, column) > most)) continue;
      const float kept = std::sqrt(most / squares(row, column));
      for (int c = 0; c < 3; ++c) {
        float& value = tame[c](row, column);
        value = smooth[c](row, column) + kept * (value - smooth[c](row, column));
      }
    }
  return tame;
}

// 1 where the choice is this one, with soft borders.
cv::Mat1f share_of(const cv::Mat1i& choices, int choice) {
  cv::Mat chosen, share;
  cv::compare(choices, choice, chosen, cv::CMP_EQ);
  chosen.convertTo(share, CV_32F, 1.0 / 255);
  return mean_around(share, kBlended_px);
}

// One part of the picture; what lies near its cut borders is spoiled.
Planes denoised_part(const Planes& colours, const cv::Mat1f& given_variance, const Planes& features) {
  constexpr int kRounds = 2;  // an outlier hides its neighbours
  const LinearFits linear(features);
  Planes tame = colours;
  for (int round = 0; round < kRounds; ++round) tame = without_outliers(tame, linear.fit(tame, kTaming).colours);
  std::vector<Smoothed> fits;
  for (int level = 0; level < kLevels; ++level) fits.push_back(linear.fit(tame, level));
  const cv::Mat1f variance = mean_around(given_variance, kJudged_px);
  cv::Mat1f least = variance.clone();  // the error of the noisy picture
  cv::Mat1i best(least.size(), -1);
  for (int i = 0; i < static_cast<int>(fits.size()); ++i) {
    const cv::Mat1f noise_left = plane_of(variance.mul(fits[i].leverage));
    const cv::Mat1f apart = mean_around(squared_difference(tame, fits[i].colours) + 2 * noise_left, kJudged_px);
    const cv::Mat1f risk = plane_of(apart - variance);
    cv::Mat better;
    cv::compare(risk, least, better, cv::CMP_LT);
    best.setTo(i, better);
    risk.copyTo(least, better);
  }
  Planes choice;
  for (const cv::Mat1f& colour : colours) choice.emplace_back(colour.size(), 0.0f);
  for (int i = -1; i < static_cast<int>(fits.size()); ++i) {
    const cv::Mat1f share = share_of(best, i);
    for (int c = 0; c < 3; ++c) choice[c] += share.mul(i < 0 ? colours[c] : fits[i].colours[c]);
  }
  return choice;
}

}  // namespace

NoisyPicture noisy_picture(const Film& film) {
  NoisyPicture picture{.mean = mean_radiance(film), .variance = variance_of_mean(film)};
  if (picture.variance.empty()) throw std::invalid_argument("the noise of a single batch of samples is unknown");
  return picture;
}

NoisyPicture noisy_picture(const Film& one, const Film& other) {
  const cv::Size size = one.counts.size();
  if (other.counts.size() != size) throw std::invalid_argument("two films of one picture have different sizes");
  NoisyPicture picture{.mean = cv::Mat3f(size, cv::Vec3f::all(0)), .variance = cv::Mat1f(size, 0.0f)};
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      const double n = one.counts(row, column), m = other.counts(row, column);
      if (!(n > 0 && m > 0)) continue;
      const cv::Vec3d &sum = one.sums(row, column), &other_sum = other.sums(row, column);
      const double apart = cv::norm(sum / n - other_sum / m);
      picture.mean(row, column) = cv::Vec3f((sum + other_sum) / (n + m));
      picture.variance(row, column) = static_cast<float>(apart * apart * n * m / ((n + m) * (n + m)));
    }
  return picture;
}

cv::Mat3f denoised(const NoisyPicture& picture) {
  const cv::Size size = picture.mean.size();
  const cv::Rect whole({0, 0}, size);
  if (picture.features.size() + 2 > kMostFeatures) throw std::invalid_argument("too many features to denoise by");
  for (const cv::Mat1f& feature : picture.features)
    if (feature.size() != size) throw std::invalid_argument("a feature has not the size of the picture");
  if (picture.variance.size() != size) throw std::invalid_argument("the variance has not the size of the picture");
  Planes colours(3);
  cv::split(picture.mean, colours.data());
  const Planes features = standardized(picture.features);
  cv::Mat3f result(size);
  std::vector<cv::Rect> parts;
  for (int row = 0; row < size.height; row += kTogether_px)
    for (int column = 0; column < size.width; column += kTogether_px)
      parts.push_back(cv::Rect(column, row, kTogether_px, kTogether_px) & whole);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    const cv::Rect part = parts[i];
    const cv::Rect seen =
        cv::Rect(part.x - kHalo_px, part.y - kHalo_px, part.width + 2 * kHalo_px, part.height + 2 * kHalo_px) & whole;
    // Mirrored at the picture's end to whole blocks.
    const auto whole_blocks = [](int side) {
      return std::max(LinearFits::kLeastSide_px, (side + kLargestBlock_px - 1) / kLargestBlock_px * kLargestBlock_px);
    };
    const cv::Size blocks(whole_blocks(seen.width), whole_blocks(seen.height));
    const auto cut = [&](const cv::Mat1f& plane) {
      cv::Mat1f region;
      cv::copyMakeBorder(plane(seen), region, 0, blocks.height - seen.height, 0, blocks.width - seen.width,
                         cv::BORDER_REFLECT | cv::BORDER_ISOLATED);
      return region;
    };
    Planes of_part = places(blocks);
    for (const cv::Mat1f& feature : features) of_part.push_back(cut(feature));
    Planes rgb{cut(colours[0]), cut(colours[1]), cut(colours[2])};
    rgb = denoised_part(rgb, cut(picture.variance), of_part);
    cv::Mat3f together;
    cv::merge(rgb.data(), 3, together);
    cv::max(together(part - seen.tl()), cv::Scalar::all(0), result(part));
  });
  return result;
}

}  // namespace renderer
