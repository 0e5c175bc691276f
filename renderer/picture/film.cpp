#include "renderer/picture/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

int tiles_along(int pixels) {
  return (pixels + kTile - 1) / kTile;
}

// The samples, in whole batches, after which a tile's error should be down to `noise`; at least one batch more than
// `samples` where it is not yet. The error falls with the root of their number.
int wanted_samples(int samples, double error, double noise) {
  if (error <= noise) return samples;
  const double ratio = std::min(error / noise, 1e3);
  const double batches = std::min(std::ceil(samples * ratio * ratio / kBatch), 1e8 / kBatch);
  return std::max(samples + kBatch, kBatch * static_cast<int>(batches));
}

int batches_of(int samples) {
  return (samples + kBatch - 1) / kBatch;
}

// The sum of a batch of n samples has a variance in proportion to n, also that of the last batch, which may be smaller.
double variance_at(const Film& film, int row, int column) {
  const int count = film.counts(row, column), batches = batches_of(count);
  const double sum = cv::norm(film.sums(row, column)), mean = sum / count;
  return std::max(0.0, film.squares(row, column) - sum * mean) / (batches - 1.0) / count;
}

}  // namespace

Film empty_film(int width, int height) {
  return {.sums = cv::Mat_<cv::Vec3d>(height, width, cv::Vec3d::all(0)),
          .squares = cv::Mat1d(height, width, 0.0),
          .counts = cv::Mat1i(height, width, 0),
          .goals = cv::Mat1i(1, tiles_along(width) * tiles_along(height), 0)};
}

cv::Rect tile_of(const cv::Size& picture, int number) {
  const int along = tiles_along(picture.width);
  return cv::Rect(number % along * kTile, number / along * kTile, kTile, kTile) & cv::Rect({0, 0}, picture);
}

std::vector<cv::Rect> tiles_of(const cv::Size& picture) {
  std::vector<cv::Rect> tiles;
  for (int i = 0; i < tiles_along(picture.width) * tiles_along(picture.height); ++i)
    tiles.push_back(tile_of(picture, i));
  return tiles;
}

int tile_at(const cv::Size& picture, int column, int row) {
  return row / kTile * tiles_along(picture.width) + column / kTile;
}

cv::Mat3f mean_radiance(const Film& film) {
  cv::Mat3f image(film.counts.size(), cv::Vec3f::all(0));
  image.forEach([&film](cv::Vec3f& pixel, const int* at) {
    const int count = film.counts(at[0], at[1]);
    const cv::Vec3d& sum = film.sums(at[0], at[1]);
    for (int c = 0; c < 3 && count > 0; ++c) pixel[c] = static_cast<float>(sum[c] / count);
  });
  return image;
}

cv::Mat1f variance_of_mean(const Film& film) {
  cv::Mat1f variance(film.counts.size(), 0.0f);
  for (int row = 0; row < variance.rows; ++row)
    for (int column = 0; column < variance.cols; ++column) {
      const int count = film.counts(row, column);
      if (count == 0) continue;
      if (batches_of(count) == 1) return {};
      variance(row, column) = static_cast<float>(variance_at(film, row, column));
    }
  return variance;
}

std::uint64_t samples_in(const Film& film) {
  return static_cast<std::uint64_t>(cv::sum(film.counts)[0]);  // exact below 2^53
}

std::size_t bytes_of(const Film& film) {
  const auto bytes = [](const cv::Mat& plane) { return plane.total() * plane.elemSize(); };
  return bytes(film.sums) + bytes(film.squares) + bytes(film.counts) + bytes(film.goals);
}

double relative_error(const Film& film, const cv::Rect& pixels, double least_brightness) {
  double error2 = 0, brightness = 0;
  int seen = 0;
  for (int row = pixels.y; row < pixels.y + pixels.height; ++row) {
    for (int column = pixels.x; column < pixels.x + pixels.width; ++column) {
      const int count = film.counts(row, column);
      if (count == 0) continue;
      if (batches_of(count) == 1) return std::numeric_limits<double>::infinity();
      error2 += variance_at(film, row, column);
      brightness += cv::norm(film.sums(row, column)) / count;
      ++seen;
    }
  }
  const double least = std::max(least_brightness * seen, std::numeric_limits<double>::min());
  return std::sqrt(error2 * seen) / std::max(brightness, least);
}

std::vector<double> relative_errors_of_tiles(const Film& film) {
  constexpr double kDark = 0.05;
  double brightness = 0;
  for (int row = 0; row < film.counts.rows; ++row)
    for (int column = 0; column < film.counts.cols; ++column)
      brightness += cv::norm(film.sums(row, column)) / std::max(1, film.counts(row, column));
  const double least = kDark * brightness / std::max(1, cv::countNonZero(film.counts));
  std::vector<double> errors;
  for (const cv::Rect& tile : tiles_of(film.counts.size())) errors.push_back(relative_error(film, tile, least));
  return errors;
}

bool raise_goals(Film& film, int most_samples, double noise) {
  const std::vector<double> errors = noise > 0 ? relative_errors_of_tiles(film) : std::vector<double>{};
  bool raised = false;
  for (int i = 0; i < film.goals.cols; ++i) {
    int& goal = film.goals(i);
    if (goal >= most_samples) continue;
    int next = std::max(2 * goal, kBatch);
    if (noise > 0 && goal >= kLeastJudged) {
      const double error = errors[static_cast<std::size_t>(i)];
      if (error <= noise) continue;
      next = std::min(next, wanted_samples(goal, error, noise));
    }
    goal = std::min(most_samples, next);
    raised = true;
  }
  return raised;
}

double expected_samples(const Film& film, const std::vector<int>& tiles, int most_samples, double noise) {
  const std::vector<double> errors = noise > 0 ? relative_errors_of_tiles(film) : std::vector<double>{};
  double sum = 0;
  for (const int tile : tiles) {
    const int goal = film.goals(tile);
    int expected = most_samples;
    if (noise > 0 && goal >= kLeastJudged && goal < most_samples)
      expected = std::clamp(wanted_samples(goal, errors[static_cast<std::size_t>(tile)], noise), goal, most_samples);
    sum += static_cast<double>(expected) * tile_of(film.counts.size(), tile).area();
  }
  return sum;
}

std::uint64_t samples_in(const Film& film, const std::vector<int>& tiles) {
  double sum = 0;  // exact below 2^53
  for (const int tile : tiles) sum += cv::sum(film.counts(tile_of(film.counts.size(), tile)))[0];
  return static_cast<std::uint64_t>(sum);
}

}  // namespace renderer
