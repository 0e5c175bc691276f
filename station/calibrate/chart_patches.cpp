#include "station/calibrate/chart_patches.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "calibration/colour_chart.h"
#include "station/views.h"

namespace station {
namespace {

constexpr double kUsedFraction = 0.6;  // of a patch's edge: away from its border, and from the pose's error

}  // namespace

std::vector<Eigen::Vector3d> chart_colours(const calibration::Developed& picture, const calibration::Lens& lens,
                                           const Eigen::Isometry3d& world_from_camera,
                                           const Eigen::Isometry3d& camera_from_chart, const ColourChart& chart,
                                           const calibration::LightFit& light) {
  const renderer::Camera camera = camera_of(lens, camera_from_chart.inverse(), false);
  const Eigen::Isometry3d world_from_chart = world_from_camera * camera_from_chart;
  const double half = chart.patch_mm * kUsedFraction / 2;
  const cv::Rect frame(0, 0, picture.radiance.cols, picture.radiance.rows);
  std::vector<Eigen::Vector3d> colours;
  for (std::size_t patch = 0; patch < kChartColumns * kChartRows; ++patch) {
    colours.emplace_back(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
    const Eigen::Vector3d centre = chart_patch_centre(chart, patch);
    std::vector<cv::Point> outline;
    bool inside = true;
    for (const auto& [x, y] : {std::pair{-half, -half}, {half, -half}, {half, half}, {-half, half}}) {
      const Eigen::Vector2d pixel = renderer::project(camera, centre + Eigen::Vector3d(x, y, 0));
      outline.emplace_back(cvRound(pixel.x()), cvRound(pixel.y()));
      inside = inside && frame.contains(outline.back());
    }
    if (!inside) continue;
    cv::Mat1b mask(picture.radiance.size(), uchar{0});
    cv::fillConvexPoly(mask, outline, cv::Scalar(255));
    if (cv::countNonZero(mask & picture.saturated) > 0) continue;
    const cv::Scalar mean = cv::mean(picture.radiance, mask);
    const Eigen::Vector3d point = world_from_chart * centre;
    const double cosine = (light.positions.at(0) - point).normalized().dot(world_from_chart.linear().col(2));
    const Eigen::Vector3d diffuser = calibration::facing_irradiance(light, 0, point) * cosine / M_PI;
    colours.back() = Eigen::Vector3d(mean[0], mean[1], mean[2]).cwiseQuotient(diffuser);
  }
  return colours;
}

}  // namespace station
