#include "tests/renderer/trace/picture_comparison.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "renderer/trace/path_tracer.h"

namespace renderer {
namespace {

constexpr int kBlocks = 8;  // along each side of the picture

// Running mean and square of one number over the seeds.
struct Spread {
  double sum = 0, squares = 0;
  void add(double value) { sum += value, squares += value * value; }
  double mean(int count) const { return sum / count; }
  double standard_error(int count) const {
    return std::sqrt(std::max(0.0, squares / count - mean(count) * mean(count)) / (count - 1));
  }
};

double grey_mean(const cv::Mat3f& picture) {
  const cv::Scalar mean = cv::mean(picture);
  return (mean[0] + mean[1] + mean[2]) / 3;
}

}  // namespace

PictureComparison compare_pictures(const Scene& first, const Scene& second, const Camera& camera, int samples_per_pixel,
                                   int pictures) {
  const PathTracer one(first), other(second);
  std::vector<Spread> differences(3), blocks(kBlocks * kBlocks);
  cv::Vec3d level(0, 0, 0);
  for (int i = 0; i < pictures; ++i) {
    const RenderOptions options{.samples_per_pixel = samples_per_pixel, .seed = static_cast<std::uint64_t>(i + 1)};
    const cv::Mat3f a = one.render(camera, options), b = other.render(camera, options);
    cv::Mat3f difference;
    cv::subtract(a, b, difference);
    const cv::Scalar mean = cv::mean(difference), of_b = cv::mean(b);
    for (int c = 0; c < 3; ++c) {
      differences[static_cast<std::size_t>(c)].add(mean[c]);
      level[c] += of_b[c] / pictures;
    }
    const int width = camera.width / kBlocks, height = camera.height / kBlocks;
    for (int k = 0; k < kBlocks * kBlocks; ++k)
      blocks[static_cast<std::size_t>(k)].add(
          grey_mean(difference({k % kBlocks * width, k / kBlocks * height, width, height})));
  }
  PictureComparison found;
  for (int c = 0; c < 3; ++c) {
    const Spread& spread = differences[static_cast<std::size_t>(c)];
    found.ratio[c] = 1 + spread.mean(pictures) / level[c];
    found.standard_error[c] = spread.standard_error(pictures) / level[c];
  }
  const double grey = (level[0] + level[1] + level[2]) / 3;
  for (const Spread& block : blocks) {
    const double error = block.standard_error(pictures), mean = block.mean(pictures);
    if (error > 0) found.structure += mean * mean / (error * error) / static_cast<double>(blocks.size());
    found.largest_block = std::max(found.largest_block, std::abs(mean) / grey);
  }
  // Squares of Student's t of n degrees of freedom.
  const double n = pictures - 1;
  found.expected_structure = n / (n - 2);
  found.structure_deviation =
      std::sqrt(2 * n * n * (n - 1) / ((n - 2) * (n - 2) * (n - 4)) / static_cast<double>(blocks.size()));
  return found;
}

}  // namespace renderer
