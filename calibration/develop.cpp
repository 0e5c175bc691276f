#include "calibration/develop.h"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace calibration {
namespace {

std::string size_text(const cv::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

void check(const SensorPicture& raw, const DevelopOptions& options) {
  if (raw.mosaic.rows < 2 || raw.mosaic.cols < 2) throw std::runtime_error("develop: the raw picture has no pixels");
  if (!(raw.white_level_dn > raw.black_level_dn) || !(raw.exposure_s > 0.0)) {
    throw std::runtime_error("develop: needs a white level above the black level and an exposure time, found black " +
                             std::to_string(raw.black_level_dn) + ", white " + std::to_string(raw.white_level_dn) +
                             ", exposure " + std::to_string(raw.exposure_s) + " s: check the raw file");
  }
  for (const int channel : raw.channel) {
    if (channel < 0 || channel > 2)
      throw std::runtime_error("develop: colour " + std::to_string(channel) +
                               " in the mosaic, only red, green and blue are known");
  }
  const cv::Size size = raw.mosaic.size();
  if (options.dark_dn && options.dark_dn->size() != size) {
    throw std::runtime_error("develop: the dark frame is " + size_text(options.dark_dn->size()) +
                             " px, the picture " + size_text(size) + ": take dark frames with the same camera");
  }
  if (options.lens && cv::Size(options.lens->width_px, options.lens->height_px) != size) {
    throw std::runtime_error("develop: the lens was calibrated at " +
                             size_text({options.lens->width_px, options.lens->height_px}) + " px, the picture is " +
                             size_text(size) + ": calibrate this camera");
  }
}

// (DN - dark) / (white - black) / exposure / vignetting gain, still a mosaic.
cv::Mat1f normalised(const SensorPicture& raw, const DevelopOptions& options) {
  const double per_dn = 1.0 / ((raw.white_level_dn - raw.black_level_dn) * raw.exposure_s);
  cv::Mat1f mosaic(raw.mosaic.size());
  for (int row = 0; row < mosaic.rows; ++row) {
    for (int column = 0; column < mosaic.cols; ++column) {
      const double dark = options.dark_dn ? static_cast<double>((*options.dark_dn)(row, column)) : raw.black_level_dn;
      const double gain = options.vignetting ? options.vignetting->gain(column, row, mosaic.size()) : 1.0;
      mosaic(row, column) = static_cast<float>((raw.mosaic(row, column) - dark) * per_dn / gain);
    }
  }
  return mosaic;
}

cv::Mat1f sites_of(const SensorPicture& raw, int channel) {
  cv::Mat1f sites(raw.mosaic.size(), 0.0F);
  for (int row = 0; row < sites.rows; ++row) {
    for (int column = 0; column < sites.cols; ++column) {
      const auto cell = static_cast<std::size_t>(2 * (row % 2) + column % 2);
      if (raw.channel[cell] == channel) sites(row, column) = 1.0F;
    }
  }
  return sites;
}

cv::Mat1f spread(const cv::Mat1f& image, const cv::Mat1f& kernel) {
  cv::Mat1f out;
  cv::filter2D(image, out, CV_32F, kernel, {-1, -1}, 0.0, cv::BORDER_CONSTANT);
  return out;
}

// Bilinear demosaicing as a normalised convolution: weights of the sites that a channel has, over their sum. Inside
// the picture a linear ramp comes back exactly; at the border the sites that exist are averaged. A site of the
// channel itself has no other one in reach and keeps its own value.
Developed demosaic(const SensorPicture& raw, const cv::Mat1f& mosaic) {
  // Green sites are a quincunx, its neighbours share an edge; red and blue sites are a coarser square grid.
  const cv::Mat1f dense = (cv::Mat1f(3, 3) << 0, 1, 0, 1, 4, 1, 0, 1, 0);
  const cv::Mat1f coarse = (cv::Mat1f(3, 3) << 1, 2, 1, 2, 4, 2, 1, 2, 1);
  const cv::Mat1f too_bright = [&] {
    const double range = raw.white_level_dn - raw.black_level_dn;
    const cv::Mat1b above(raw.mosaic > raw.black_level_dn + 0.98 * range);
    cv::Mat1f flags;
    above.convertTo(flags, CV_32F, 1.0 / 255.0);
    return flags;
  }();
  std::array<cv::Mat1f, 3> channels;
  Developed out{.radiance = {}, .saturated = cv::Mat1b(mosaic.size(), uchar{0})};
  for (int c = 0; c < 3; ++c) {
    const cv::Mat1f sites = sites_of(raw, c);
    const bool is_dense = cv::countNonZero(sites) > mosaic.rows * mosaic.cols * 3 / 8;
    const cv::Mat1f& kernel = is_dense ? dense : coarse;
    // Where no site is in reach (a colour that the mosaic lacks) the sum of weights is 0, and so is the radiance.
    channels[static_cast<std::size_t>(c)] =
        spread(cv::Mat1f(mosaic.mul(sites)), kernel) / cv::max(spread(sites, kernel), 1e-6);
    out.saturated |= spread(cv::Mat1f(too_bright.mul(sites)), kernel) > 0.5;
  }
  cv::merge(channels.data(), 3, out.radiance);
  return out;
}

// Straightens the picture and keeps the intrinsic matrix; pixels that the sensor did not see become 0.
Developed undistorted(const Developed& seen, const Lens& lens) {
  const cv::Matx33d matrix(lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1);
  cv::Mat1f column, row;
  cv::initUndistortRectifyMap(matrix, std::vector<double>(lens.distortion.begin(), lens.distortion.end()),
                              cv::noArray(), matrix, seen.radiance.size(), CV_32FC1, column, row);
  Developed out;
  // Linear, because cubic weights overshoot beside highlights and would make negative radiance.
  cv::remap(seen.radiance, out.radiance, column, row, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  cv::Mat1f flags;
  seen.saturated.convertTo(flags, CV_32F);
  cv::remap(flags, flags, column, row, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  out.saturated = flags > 0.0F;
  return out;
}

}  // namespace

cv::Mat1f master_dark(const std::vector<SensorPicture>& darks) {
  if (darks.empty()) throw std::runtime_error("master dark: no dark frames were given: take at least one");
  const SensorPicture& first = darks.front();
  cv::Mat1d sum(first.mosaic.size(), 0.0);
  for (const SensorPicture& dark : darks) {
    if (dark.mosaic.size() != first.mosaic.size()) {
      throw std::runtime_error("master dark: sizes differ (" + size_text(first.mosaic.size()) + " and " +
                               size_text(dark.mosaic.size()) + " px): use dark frames of one camera");
    }
    if (std::abs(dark.exposure_s - first.exposure_s) > 1e-3 * first.exposure_s || dark.iso != first.iso) {
      throw std::runtime_error("master dark: exposures differ (" + std::to_string(first.exposure_s) + " s at ISO " +
                               std::to_string(first.iso) + ", " + std::to_string(dark.exposure_s) + " s at ISO " +
                               std::to_string(dark.iso) + "): average dark frames of one exposure only");
    }
    cv::Mat1d values;
    dark.mosaic.convertTo(values, CV_64F);
    sum += values;
  }
  return cv::Mat1f(sum / static_cast<double>(darks.size()));
}

Developed develop(const SensorPicture& raw, const DevelopOptions& options) {
  check(raw, options);
  const Developed seen = demosaic(raw, normalised(raw, options));
  return options.lens ? undistorted(seen, *options.lens) : seen;
}

}  // namespace calibration
