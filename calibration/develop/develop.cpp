#include "calibration/develop/develop.h"

#include <algorithm>
#include <initializer_list>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "calibration/develop/demosaic.h"
#include "calibration/sensor/picture_stack.h"
#include "calibration/sensor/size_text.h"

namespace calibration {
namespace {

void require_fitting(const SensorPicture& raw, const DevelopOptions& options) {
  const cv::Size size = raw.mosaic.size();
  if (options.lens && cv::Size(options.lens->width_px, options.lens->height_px) != size) {
    throw std::runtime_error("develop: the lens was calibrated at " +
                             size_text({options.lens->width_px, options.lens->height_px}) + " px, the picture is " +
                             size_text(size) + ": calibrate this camera");
  }
  if (options.part && (options.lens || options.part->empty() || (*options.part & cv::Rect({}, size)) != *options.part))
    throw std::runtime_error("develop: a part of " + size_text(options.part->size()) +
                             " px was asked for, the picture is " + size_text(size) +
                             ": ask for a part inside it, without a lens to straighten it by");
}

constexpr int kBand = 64;  // rows; enough to be worth a call, few enough to stay in the processor's cache

// Does `work` on bands of rows, several at once.
template <typename Work>
void for_each_band(int rows, const Work& work) {
  cv::parallel_for_({0, (rows + kBand - 1) / kBand}, [&](const cv::Range& bands) {
    for (int band = bands.start; band < bands.end; ++band)
      work(cv::Range(band * kBand, std::min(rows, (band + 1) * kBand)));
  });
}

// Divides `mosaic`, a part of the sensor that begins at `origin`, by the vignetting; `sensor` is the sensor's size.
void take_out(const Vignetting& vignetting, const cv::Point& origin, const cv::Size& sensor, LinearMosaic& mosaic) {
  for_each_band(mosaic.radiance.rows, [&](const cv::Range& rows) {
    for (int row = rows.start; row < rows.end; ++row) {
      for (int column = 0; column < mosaic.radiance.cols; ++column) {
        const auto gain = static_cast<float>(vignetting.gain(origin.x + column, origin.y + row, sensor));
        mosaic.radiance(row, column) /= gain;
        if (!mosaic.variance.empty()) mosaic.variance(row, column) /= gain * gain;
      }
    }
  });
}

Developed pictures_like(const LinearMosaic& raw) {
  const cv::Size size = raw.radiance.size();
  return {.radiance = cv::Mat3f(size),
          .variance = raw.variance.empty() ? cv::Mat3f() : cv::Mat3f(size),
          .saturated = cv::Mat1b(size)};
}

// The region of the sensor that demosaicing and the repair of bad pixels need for `part`; it begins at a whole cell.
cv::Rect needed_for(const cv::Rect& part, const cv::Size& sensor) {
  constexpr int kReach = 4;
  const int left = std::max(0, part.x - kReach) / 2 * 2, top = std::max(0, part.y - kReach) / 2 * 2;
  return cv::Rect({left, top}, part.br() + cv::Point(kReach, kReach)) & cv::Rect({}, sensor);
}

std::vector<SensorPicture> cut(std::vector<SensorPicture> bracket, const cv::Rect& part) {
  for (SensorPicture& raw : bracket) raw.mosaic = raw.mosaic(part);
  return bracket;
}

SensorResponse cut(SensorResponse response, const cv::Rect& part) {
  SensorMaps& maps = response.maps;
  for (cv::Mat* map : std::initializer_list<cv::Mat*>{&maps.bias_dn, &maps.dark_dn_per_s, &maps.flat, &maps.bad})
    if (!map->empty()) *map = (*map)(part);
  return response;
}

Developed cut(const Developed& developed, const cv::Rect& part) {
  return {.radiance = developed.radiance(part),
          .variance = developed.variance.empty() ? cv::Mat3f() : developed.variance(part),
          .saturated = developed.saturated(part)};
}

// The picture without distortion, with the same intrinsic matrix; pixels that the sensor did not see become 0.
Developed undistorted(const Developed& seen, const Lens& lens) {
  const cv::Size size = seen.radiance.size();
  cv::Mat1f flags;
  seen.saturated.convertTo(flags, CV_32F);
  Developed out{.radiance = cv::Mat3f(size),
                .variance = seen.variance.empty() ? cv::Mat3f() : cv::Mat3f(size),
                .saturated = cv::Mat1b(size)};
  const cv::Matx33d matrix(lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1);
  for_each_band(size.height, [&](const cv::Range& rows) {
    cv::Matx33d of_band = matrix;
    of_band(1, 2) -= rows.start;
    cv::Mat1f column, row, flag;
    cv::initUndistortRectifyMap(matrix, std::vector<double>(lens.distortion.begin(), lens.distortion.end()),
                                cv::noArray(), of_band, {size.width, rows.size()}, CV_32FC1, column, row);
    // Interpolation is linear, because cubic weights overshoot beside highlights and would make negative radiance.
    const auto straighten = [&](const cv::Mat& from, cv::Mat to) {
      cv::remap(from, to, column, row, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    };
    straighten(seen.radiance, out.radiance.rowRange(rows));
    if (!seen.variance.empty()) straighten(seen.variance, out.variance.rowRange(rows));
    cv::remap(flags, flag, column, row, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    out.saturated.rowRange(rows).setTo(0);
    out.saturated.rowRange(rows).setTo(255, flag > 0.0F);
  });
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
  require_mergeable(bracket, response);
  require_fitting(bracket.front(), options);
  const cv::Size sensor = bracket.front().mosaic.size();
  const cv::Rect part = options.part.value_or(cv::Rect({}, sensor)), needed = needed_for(part, sensor);
  LinearMosaic mosaic = merge_exposures(cut(bracket, needed), cut(std::move(response), needed), options.dark_offset_dn);
  if (options.vignetting) take_out(*options.vignetting, needed.tl(), sensor, mosaic);
  Developed seen = pictures_like(mosaic);
  for_each_band(mosaic.radiance.rows, [&](const cv::Range& rows) { demosaic_rows(mosaic, rows, seen); });
  mosaic = {};
  if (options.part) return cut(seen, part - needed.tl());
  return options.lens ? undistorted(seen, *options.lens) : seen;
}

}  // namespace calibration
