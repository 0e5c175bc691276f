#include "station/bench/calibrate/chart_squares.h"

#include <array>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>
#include <utility>

#include "calibration/develop/polygon_mask.h"
#include "calibration/light/colour_chart.h"
#include "station/bench/camera_adapter.h"

namespace station {
namespace {

constexpr double kUsedOfSquare = 0.6;  // of a square's edge: away from its border, and from the pose's error
constexpr std::array<std::pair<int, int>, 4> kSquare{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};

}  // namespace

std::vector<Eigen::Vector3d> chart_colours(const calibration::Developed& picture, const calibration::Lens& lens,
                                           const Eigen::Isometry3d& world_from_camera,
                                           const Eigen::Isometry3d& camera_from_chart, const ColourChart& chart,
                                           const calibration::LightFit& light) {
  const renderer::Camera camera = camera_of(lens, camera_from_chart.inverse(), false);
  const Eigen::Isometry3d world_from_chart = world_from_camera * camera_from_chart;
  const double half = chart.square_mm * kUsedOfSquare / 2;
  const cv::Rect frame(0, 0, picture.radiance.cols, picture.radiance.rows);
  std::vector<Eigen::Vector3d> colours;
  for (std::size_t square = 0; square < kChartColumns * kChartRows; ++square) {
    colours.emplace_back(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
    const Eigen::Vector3d centre = chart_square_centre(chart, square);
    std::array<Eigen::Vector2d, 4> corners;
    bool inside = true;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector3d to_corner(kSquare[i].first * half, kSquare[i].second * half, 0);
      corners[i] = renderer::project(camera, centre + to_corner);
      inside = inside && frame.contains(cv::Point(cvRound(corners[i].x()), cvRound(corners[i].y())));
    }
    if (!inside) continue;
    const cv::Mat1b mask = calibration::polygon_mask(picture.radiance.size(), corners);
    if (cv::countNonZero(mask & picture.saturated) > 0) continue;
    const cv::Scalar mean = cv::mean(picture.radiance, mask);
    const Eigen::Vector3d point = world_from_chart * centre;
    const double cosine = (light.positions.at(0) - point).normalized().dot(world_from_chart.linear().col(2));
    const Eigen::Vector3d diffuser = calibration::facing_irradiance(light, 0, point) * cosine / std::numbers::pi;
    colours.back() = Eigen::Vector3d(mean[0], mean[1], mean[2]).cwiseQuotient(diffuser);
  }
  return colours;
}

}  // namespace station
