#include "station/bench/calibrate/panel_spots.h"

#include <opencv2/imgproc.hpp>
#include <optional>

#include "calibration/develop/develop.h"
#include "calibration/light/light_plan.h"
#include "station/bench/camera_adapter.h"

namespace station {
namespace {

constexpr int kCells = 5;       // across the white square, each way
constexpr int kMinPixels = 30;  // per cell, for a mean and its error
// Tag pose, flat panel and demosaicing are not known better than this; keeps bright cells from dominating.
constexpr double kRelativeFloor = 2e-3;

struct CellMean {
  Eigen::Vector3d mean, standard_error;
};

std::optional<CellMean> mean_inside(const calibration::Developed& picture, const std::vector<cv::Point2f>& outline) {
  const cv::Rect frame(0, 0, picture.radiance.cols, picture.radiance.rows);
  for (const cv::Point2f& corner : outline)
    if (!frame.contains(cv::Point(cvRound(corner.x), cvRound(corner.y)))) return std::nullopt;
  const cv::Rect box = cv::boundingRect(outline) & frame;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  int count = 0;
  for (int row = box.y; row < box.y + box.height; ++row)
    for (int column = box.x; column < box.x + box.width; ++column) {
      if (cv::pointPolygonTest(outline, cv::Point2f(static_cast<float>(column), static_cast<float>(row)), false) < 0)
        continue;
      if (picture.saturated(row, column)) return std::nullopt;
      const cv::Vec3f& p = picture.radiance(row, column);
      const Eigen::Vector3d value(p[0], p[1], p[2]);
      sum += value;
      squares += value.cwiseAbs2();
      ++count;
    }
  if (count < kMinPixels) return std::nullopt;
  const Eigen::Vector3d mean = sum / count;
  const Eigen::Vector3d variance = (squares / count - mean.cwiseAbs2()).cwiseMax(0.0) / count;
  return CellMean{mean, (variance + (kRelativeFloor * mean).cwiseAbs2()).cwiseSqrt()};
}

}  // namespace

std::vector<calibration::PanelSpot> panel_spots(const calibration::Developed& picture, const calibration::Lens& lens,
                                                const Eigen::Isometry3d& world_from_camera,
                                                const Eigen::Isometry3d& camera_from_panel,
                                                const SpectralonPanel& panel, int light, int number) {
  const Eigen::Isometry3d panel_from_camera = camera_from_panel.inverse();
  const renderer::Camera camera = camera_of(lens, panel_from_camera, false);
  const Eigen::Isometry3d world_from_panel = world_from_camera * camera_from_panel;
  const Eigen::Vector3d eye = world_from_camera.translation();
  const double cell = calibration::panel_cell_mm(panel.white_mm, kCells);
  std::vector<calibration::PanelSpot> spots;
  for (const Eigen::Vector3d& centre : calibration::panel_cells(panel.white_mm, kCells)) {
    std::vector<cv::Point2f> outline;
    for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      const Eigen::Vector2d pixel = renderer::project(camera, centre + Eigen::Vector3d(x * cell, y * cell, 0));
      outline.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    }
    const auto measured = mean_inside(picture, outline);
    if (!measured) continue;
    const Eigen::Vector3d point = world_from_panel * centre;
    spots.push_back({.light = light,
                     .picture = number,
                     .point = point,
                     .normal = world_from_panel.linear().col(2),
                     .to_camera = (eye - point).normalized(),
                     .pixel = renderer::project(camera, centre),
                     .radiance = measured->mean,
                     .sigma = measured->standard_error});
  }
  return spots;
}

}  // namespace station
