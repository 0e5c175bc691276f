#include "calibration/develop.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "calibration/picture_stack.h"

namespace calibration {
namespace {

std::string size_text(const cv::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

void check(const SensorPicture& raw, const DevelopOptions& options) {
  for (const int channel : raw.channel) {
    if (channel < 0 || channel > 2)
      throw std::runtime_error("develop: colour " + std::to_string(channel) +
                               " in the mosaic, only red, green and blue are known");
  }
  const cv::Size size = raw.mosaic.size();
  if (options.lens && cv::Size(options.lens->width_px, options.lens->height_px) != size) {
    throw std::runtime_error("develop: the lens was calibrated at " +
                             size_text({options.lens->width_px, options.lens->height_px}) + " px, the picture is " +
                             size_text(size) + ": calibrate this camera");
  }
}

void take_out(const Vignetting& vignetting, LinearMosaic& mosaic) {
  for (int row = 0; row < mosaic.radiance.rows; ++row) {
    for (int column = 0; column < mosaic.radiance.cols; ++column) {
      const auto gain = static_cast<float>(vignetting.gain(column, row, mosaic.radiance.size()));
      mosaic.radiance(row, column) /= gain;
      if (!mosaic.variance.empty()) mosaic.variance(row, column) /= gain * gain;
    }
  }
}

cv::Mat1f sites_of(const LinearMosaic& raw, int channel) {
  cv::Mat1f sites(raw.radiance.size(), 0.0F);
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
Developed demosaic(const LinearMosaic& raw) {
  const cv::Mat1f& mosaic = raw.radiance;
  // Green sites are a quincunx, its neighbours share an edge; red and blue sites are a coarser square grid.
  const cv::Mat1f dense = (cv::Mat1f(3, 3) << 0, 1, 0, 1, 4, 1, 0, 1, 0);
  const cv::Mat1f coarse = (cv::Mat1f(3, 3) << 1, 2, 1, 2, 4, 2, 1, 2, 1);
  cv::Mat1f too_bright;
  raw.saturated.convertTo(too_bright, CV_32F, 1.0 / 255.0);
  std::array<cv::Mat1f, 3> channels, variances;
  Developed out{.radiance = {}, .variance = {}, .saturated = cv::Mat1b(mosaic.size(), uchar{0})};
  for (int c = 0; c < 3; ++c) {
    const cv::Mat1f sites = sites_of(raw, c);
    const bool is_dense = cv::countNonZero(sites) > mosaic.rows * mosaic.cols * 3 / 8;
    const cv::Mat1f& kernel = is_dense ? dense : coarse;
    // Where no site is in reach (a colour that the mosaic lacks) the sum of weights is 0, and so is the radiance.
    const cv::Mat1f weights(cv::max(spread(sites, kernel), 1e-6));
    channels[static_cast<std::size_t>(c)] = spread(cv::Mat1f(mosaic.mul(sites)), kernel) / weights;
    if (!raw.variance.empty()) {
      variances[static_cast<std::size_t>(c)] =
          spread(cv::Mat1f(raw.variance.mul(sites)), cv::Mat1f(kernel.mul(kernel))) / weights.mul(weights);
    }
    out.saturated |= spread(cv::Mat1f(too_bright.mul(sites)), kernel) > 0.5;
  }
  cv::merge(channels.data(), 3, out.radiance);
  if (!raw.variance.empty()) cv::merge(variances.data(), 3, out.variance);
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
  if (!seen.variance.empty())
    cv::remap(seen.variance, out.variance, column, row, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  cv::Mat1f flags;
  seen.saturated.convertTo(flags, CV_32F);
  cv::remap(flags, flags, column, row, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  out.saturated = flags > 0.0F;
  return out;
}

}  // namespace

cv::Mat1f master_dark(const std::vector<SensorPicture>& darks) {
  PictureStack stack;
  for (const SensorPicture& dark : darks) stack.add(dark);
  return stack.mean_dn();
}

Developed develop(const SensorPicture& raw, const DevelopOptions& options) {
  return develop(std::vector<SensorPicture>{raw}, options);
}

Developed develop(const std::vector<SensorPicture>& bracket, const DevelopOptions& options) {
  SensorResponse response = options.response ? *options.response : SensorResponse{};
  if (options.dark_dn) {
    response.maps.bias_dn = *options.dark_dn;
    response.maps.dark_dn_per_s = {};
  }
  LinearMosaic mosaic = merge_exposures(bracket, response, options.dark_offset_dn);
  check(bracket.front(), options);
  if (options.vignetting) take_out(*options.vignetting, mosaic);
  const Developed seen = demosaic(mosaic);
  return options.lens ? undistorted(seen, *options.lens) : seen;
}

}  // namespace calibration
