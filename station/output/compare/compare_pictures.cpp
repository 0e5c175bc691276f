#include "station/output/compare/compare_pictures.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "calibration/light/colour_chart.h"
#include "inversion/view/blocks.h"
#include "station/documents/degree.h"
#include "station/documents/matrix_rows.h"
#include "station/output/display.h"

namespace station {
namespace {

constexpr double kWhitestDeltaE = 20;

struct BlockPair {
  const inversion::Block block;
  Eigen::Array3d photograph, rendering;  // scaled
  double delta_e = 0;
};

cv::Mat1b whole_if_empty(const cv::Mat1b& mask, const cv::Mat3f& picture) {
  return mask.empty() ? cv::Mat1b(picture.size(), static_cast<unsigned char>(255)) : mask;
}

void check(const cv::Mat3f& photograph, const cv::Mat3f& rendering, const cv::Mat1b& mask) {
  const auto size = [](const cv::Mat& picture) {
    return std::to_string(picture.cols) + " x " + std::to_string(picture.rows);
  };
  if (photograph.size() != rendering.size() || photograph.size() != mask.size())
    throw std::runtime_error("photograph (" + size(photograph) + "), rendering (" + size(rendering) + ") and mask (" +
                             size(mask) + ") differ in size; render with the photograph's camera");
  if (cv::countNonZero(mask) == 0) throw std::runtime_error("the mask is empty; give one that shows the cloth");
}

// Least squares over pixels would divide by the mean square of the rendering, which noise of few samples, and yarns
// that lie elsewhere, make several times that of what is rendered: a cloth of 16 samples a pixel came out at a fifth of
// its brightness, and 16 CIEDE2000 off.
double fitted_scale(const cv::Mat3f& photograph, const cv::Mat3f& rendering, const cv::Mat1b& mask) {
  double photographed = 0, rendered = 0;
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.cols; ++column)
      for (int c = 0; mask(row, column) != 0 && c < 3; ++c)
        photographed += photograph(row, column)[c], rendered += rendering(row, column)[c];
  if (!(photographed > 0) || !(rendered > 0))
    throw std::runtime_error("one of the pictures has no light inside the mask; check that they show the same view");
  return photographed / rendered;
}

std::vector<BlockPair> block_pairs(const cv::Mat3f& photograph, const cv::Mat3f& rendering, const cv::Mat1b& mask,
                                   double scale, const CompareOptions& options) {
  const double white = display_scale(photograph, mask);
  const Eigen::Matrix3d colour = matrix_of(options.linear_srgb_from_camera);
  const auto lab = [&](const Eigen::Array3d& camera) {
    return calibration::lab_of_linear_srgb(colour * (camera * white).max(0).matrix());
  };
  std::vector<BlockPair> pairs;
  for (const inversion::Block& block : inversion::mask_blocks(mask, options.block_px)) {
    BlockPair pair{.block = block,
                   .photograph = inversion::block_mean(block, photograph),
                   .rendering = scale * inversion::block_mean(block, rendering)};
    pair.delta_e = calibration::delta_e_2000(lab(pair.photograph), lab(pair.rendering));
    pairs.push_back(pair);
  }
  if (pairs.empty()) throw std::runtime_error("the mask is smaller than one block; give a larger one");
  return pairs;
}

// The mean of each column inside the mask; black where it has no pixel.
std::vector<Eigen::Array3d> column_means(const cv::Mat3f& picture, const cv::Mat1b& mask, double scale) {
  std::vector<Eigen::Array3d> means;
  for (int column = 0; column < picture.cols; ++column) {
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    int count = 0;
    for (int row = 0; row < picture.rows; ++row) {
      if (mask(row, column) == 0) continue;
      const cv::Vec3f& pixel = picture(row, column);
      sum += scale * Eigen::Array3d(pixel[0], pixel[1], pixel[2]);
      ++count;
    }
    means.push_back(sum / std::max(1, count));
  }
  return means;
}

double brightest(const std::vector<Eigen::Array3d>& columns) {
  double most = 0;
  for (const Eigen::Array3d& column : columns) most = std::max(most, column.mean());
  return most;
}

// Brightness in units of `unit`.
HighlightProfile highlight_of(const std::vector<Eigen::Array3d>& columns, double unit, const Eigen::Matrix3d& colour) {
  HighlightProfile profile;
  for (const Eigen::Array3d& column : columns) profile.brightness.push_back(column.mean() / unit);
  const int count = static_cast<int>(columns.size()), reach = std::max(1, count / 100);
  std::vector<double> smooth(columns.size(), 0);
  for (int i = 0; i < count; ++i) {
    const int from = std::max(0, i - reach), to = std::min(count - 1, i + reach);
    for (int j = from; j <= to; ++j)
      smooth[static_cast<std::size_t>(i)] += profile.brightness[static_cast<std::size_t>(j)] / (to - from + 1);
  }
  const auto peak = std::ranges::max_element(smooth);
  profile.peak_px = static_cast<double>(peak - smooth.begin());
  profile.peak = *peak;
  Eigen::Array3d light = Eigen::Array3d::Zero();
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (smooth[i] > profile.peak / 2) light += columns[i], profile.width_px += 1;
  if (light.maxCoeff() > 0) {
    const Eigen::Vector3d lab =
        calibration::lab_of_linear_srgb((colour * (light / light.maxCoeff()).matrix()).cwiseMax(0));
    profile.hue_deg = std::atan2(lab.z(), lab.y()) / kDegree;
  }
  return profile;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const Eigen::Map<const Eigen::ArrayXd> x(a.data(), static_cast<Eigen::Index>(a.size())),
      y(b.data(), static_cast<Eigen::Index>(b.size()));
  const Eigen::ArrayXd dx = x - x.mean(), dy = y - y.mean();
  const double spread = std::sqrt(dx.square().sum() * dy.square().sum());
  return spread > 0 ? (dx * dy).sum() / spread : 0;
}

}  // namespace

Comparison compare_pictures(const cv::Mat3f& photograph, const cv::Mat3f& rendering, const cv::Mat1b& some_mask,
                            const CompareOptions& options) {
  const cv::Mat1b mask = whole_if_empty(some_mask, photograph);
  check(photograph, rendering, mask);
  Comparison result;
  result.scale = options.fit_scale ? fitted_scale(photograph, rendering, mask) : 1;
  const cv::Scalar photographed_mean = cv::mean(photograph, mask), rendered_mean = cv::mean(rendering, mask);
  for (int c = 0; c < 3; ++c)
    if (photographed_mean[c] > 0)
      result.brightness[static_cast<std::size_t>(c)] = rendered_mean[c] / photographed_mean[c];
  const std::vector<BlockPair> pairs = block_pairs(photograph, rendering, mask, result.scale, options);
  std::vector<double> delta_e;
  double error = 0, signal = 0;
  for (const BlockPair& pair : pairs) {
    delta_e.push_back(pair.delta_e);
    error += (pair.rendering - pair.photograph).square().sum(), signal += pair.photograph.square().sum();
  }
  std::ranges::sort(delta_e);
  result.blocks = static_cast<int>(pairs.size());
  for (const double value : delta_e) result.mean_delta_e += value / result.blocks;
  result.median_delta_e = delta_e[delta_e.size() / 2];
  result.delta_e_95 = delta_e[delta_e.size() * 95 / 100];
  result.relative_rmse = std::sqrt(error / signal);
  const Eigen::Matrix3d colour = matrix_of(options.linear_srgb_from_camera);
  const auto photographed = column_means(photograph, mask, 1), rendered = column_means(rendering, mask, result.scale);
  result.photograph = highlight_of(photographed, brightest(photographed), colour);
  result.rendering = highlight_of(rendered, brightest(photographed), colour);
  result.profile_correlation = correlation(result.photograph.brightness, result.rendering.brightness);
  return result;
}

nlohmann::json to_json(const Comparison& comparison) {
  const auto highlight = [](const HighlightProfile& profile) -> nlohmann::json {
    return {{"peak_px", profile.peak_px},
            {"peak", profile.peak},
            {"width_px", profile.width_px},
            {"hue_deg", profile.hue_deg},
            {"brightness", profile.brightness}};
  };
  return {{"scale", comparison.scale},
          {"brightness", comparison.brightness},
          {"blocks", comparison.blocks},
          {"mean_delta_e_2000", comparison.mean_delta_e},
          {"median_delta_e_2000", comparison.median_delta_e},
          {"delta_e_2000_95", comparison.delta_e_95},
          {"relative_rmse", comparison.relative_rmse},
          {"profile_correlation", comparison.profile_correlation},
          {"photograph", highlight(comparison.photograph)},
          {"rendering", highlight(comparison.rendering)}};
}

cv::Mat3b comparison_picture(const cv::Mat3f& photograph, const cv::Mat3f& rendering, const cv::Mat1b& some_mask,
                             const CompareOptions& options) {
  const cv::Mat1b mask = whole_if_empty(some_mask, photograph);
  check(photograph, rendering, mask);
  const double scale = options.fit_scale ? fitted_scale(photograph, rendering, mask) : 1;
  const double white = display_scale(photograph, mask);
  cv::Mat3b difference(photograph.size(), cv::Vec3b(0, 0, 0));
  for (const BlockPair& pair : block_pairs(photograph, rendering, mask, scale, options)) {
    const auto grey = cv::saturate_cast<unsigned char>(255 * pair.delta_e / kWhitestDeltaE);
    for (const cv::Point& at : pair.block.pixels) difference(at) = cv::Vec3b(grey, grey, grey);
  }
  cv::Mat3b sheet;
  cv::hconcat(std::vector<cv::Mat>{display(photograph, white, options.linear_srgb_from_camera),
                                   display(rendering, white * scale, options.linear_srgb_from_camera), difference},
              sheet);
  return sheet;
}

}  // namespace station
