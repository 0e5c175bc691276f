#include "station/bench/check_picture.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "calibration/sensor/median.h"
#include "station/bench/bench_reading.h"
#include "station/bench/calibration_validity.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/exposure.h"
#include "station/bench/metering.h"
#include "station/documents/degree.h"

namespace station {
namespace {

constexpr int kMostTestPictures = 8;
constexpr double kWidestEdge_px = 3;  // out of focus by one pixel (standard deviation) is 3.2
constexpr int kFewestRingTags = 2, kFewestTableTags = 1;
constexpr double kAcross = 0.1;  // of a tag's edge, to either side: a border is one cell of eight wide

template <typename... Parts>
std::string words(const Parts&... parts) {
  std::ostringstream text;
  text.precision(3);
  (text << ... << parts);
  return text.str();
}

double grey_at(const cv::Mat1f& grey, const Eigen::Vector2d& at_px) {
  const int column = std::clamp(static_cast<int>(std::lround(at_px.x())), 0, grey.cols - 1);
  const int row = std::clamp(static_cast<int>(std::lround(at_px.y())), 0, grey.rows - 1);
  return static_cast<double>(grey(row, column));
}

// Across the middle of the edge from `a` to `b`, a pixel at a time.
double width_of_edge(const cv::Mat1f& grey, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a, middle = (a + b) / 2;
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  const int reach = std::max(2, static_cast<int>(kAcross * along.norm()));
  double least = grey_at(grey, middle), most = least, steepest = 0;
  for (int step = -reach; step < reach; ++step) {
    const double here = grey_at(grey, middle + step * across), next = grey_at(grey, middle + (step + 1) * across);
    least = std::min({least, here, next});
    most = std::max({most, here, next});
    steepest = std::max(steepest, std::abs(next - here));
  }
  return steepest > 0 ? (most - least) / steepest : 2.0 * reach;
}

int seen_of(const calibration::TagLayout& layout, const calibration::TagObservation& seen) {
  return static_cast<int>(std::ranges::count_if(seen, [&](const calibration::TagDetection& one) {
    return std::ranges::any_of(layout.tags, [&](const calibration::Tag& tag) { return tag.id == one.id; });
  }));
}

rig::ContractRow tags_row(const calibration::TagLayout& layout, const std::string& where, int fewest,
                          const calibration::TagObservation& seen) {
  const int count = seen_of(layout, seen);
  return {"tags " + where + " are seen", count >= fewest,
          words(count, " of ", layout.tags.size(),
                count >= fewest ? "" : "; light them evenly, clear what covers them and point the camera at them")};
}

rig::ContractRow stands_row(const RigCalibration& calibration, const RigFile& rig,
                            const calibration::TagObservation& seen, double reading_rad) {
  const BenchReading bench = read_bench(calibration, rig, seen);
  try {
    require_calibrated_bench(calibration, bench, reading_rad, "the test picture");
  } catch (const std::exception& error) {
    return {"the bench stands as it was calibrated", false, error.what()};
  }
  const bool read = bench.angle && bench.shift;
  return {"the bench stands as it was calibrated", read,
          read ? words("the platform's tags stand at ", bench.angle->angle_rad / kDegree, " deg, the turntable at ",
                       reading_rad / kDegree)
               : "too few tags are seen to tell; see the rows above"};
}

}  // namespace

double edge_width_px(const cv::Mat1f& grey, const calibration::TagObservation& seen) {
  std::vector<double> widths;
  for (const calibration::TagDetection& tag : seen)
    for (std::size_t corner = 0; corner < 4; ++corner)
      widths.push_back(width_of_edge(grey, tag.corners_px.at(corner), tag.corners_px.at((corner + 1) % 4)));
  return widths.empty() ? 0 : calibration::median(std::move(widths));
}

std::vector<rig::ContractRow> check_picture(const RigDevices& devices, const RigFile& rig,
                                            const RigCalibration& calibration) {
  if (devices.bench) rig::make_simulated_operator(*devices.bench)->arrange({.room_light = true});
  devices.turntable->home();
  std::optional<calibration::SensorPicture> picture;
  const ExposureAim aim{.level = rig.target_level};
  const Metering metering = meter_exposure(
      *devices.camera, {}, {.exposure_s = 0.5, .f_number = calibration.camera.f_number},
      [&](const PlanStep&, const rig::Picture& test) -> ExposureChoice {
        picture = calibration::read_sensor_bytes(test.bytes, "the test picture");
        const auto next = next_exposure_s(*picture, {}, aim);
        return {.exposure_s = next.value_or(picture->exposure_s), .done = !next};
      },
      kMostTestPictures, [] {});
  require_same_camera(calibration, *picture, "the test picture");
  const cv::Mat1f grey = linear_grey(*picture);
  const calibration::TagObservation seen = calibration::detect_tags(grey);
  const double level = bright_level(*picture, {}, aim.percentile), width_px = edge_width_px(grey, seen);
  const bool sharp = width_px > 0 && width_px <= kWidestEdge_px;
  return {
      {"an exposure is found", metering.converged,
       words(picture->exposure_s, " s, brightest at ", 100 * level, " % of the range",
             metering.converged ? "" : "; see that the room light is on and does not flicker")},
      {"the picture is in focus", sharp,
       words("edges of tags are ", width_px, " px wide",
             sharp ? "" : "; focus on the holder, tape the ring and calibrate again")},
      tags_row(rig.platform_ring, "on the platform", kFewestRingTags, seen),
      tags_row(rig.table_tags, "on the table", kFewestTableTags, seen),
      stands_row(calibration, rig, seen, devices.turntable->angle_rad()),
  };
}

}  // namespace station
