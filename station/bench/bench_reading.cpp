#include "station/bench/bench_reading.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "station/bench/bench_fault.h"
#include "station/documents/degree.h"

namespace station {
namespace {

constexpr double kStill_mm = 0.1, kStill_px = 0.3;
constexpr double kLargestSlip_rad = 0.5 * kDegree;

}  // namespace

BenchReading read_bench(const RigCalibration& calibration, const RigFile& rig,
                        const calibration::TagObservation& seen) {
  BenchReading found;
  found.shift = calibration::shift_of(calibration.still_tags, seen);
  found.angle = calibration::measure_angle(calibration.lens.lens, calibration.platform, rig.platform_ring, seen);
  // A platform measured by tape alone does not know where its ring lies.
  if (calibration.platform.readings_rad.empty()) found.angle.reset();
  if (found.angle && found.angle->tags_used < kFewestRingTags) found.angle.reset();
  return found;
}

double still_limit_px(const RigCalibration& calibration) {
  const double distance_mm =
      (calibration.platform.world_from_camera.translation() - calibration.platform.world_from_table.translation())
          .norm();
  return std::max(kStill_px, kStill_mm * calibration.lens.lens.fx_px / distance_mm);
}

std::optional<std::string> slip_problem(const RigCalibration& calibration, const BenchReading& found,
                                        double reading_rad, const std::string& picture) {
  if (!found.angle) return std::nullopt;
  const double expected_rad = calibration.platform.scale * reading_rad;
  const double slip_rad = std::remainder(found.angle->angle_rad - expected_rad, 2 * std::numbers::pi);
  if (std::abs(slip_rad) <= kLargestSlip_rad) return std::nullopt;
  char text[300];
  std::snprintf(
      text, sizeof text,
      "%s: the platform's tags stand at %.2f degrees, the turntable reads %.2f: it slipped or lost steps; see "
      "that nothing blocks it, home it and take the picture again",
      picture.c_str(), found.angle->angle_rad / kDegree, expected_rad / kDegree);
  return text;
}

void require_calibrated_bench(const RigCalibration& calibration, const BenchReading& found, double reading_rad,
                              const std::string& picture) {
  if (found.shift) {
    const auto problem = calibration::shift_problem(*found.shift, still_limit_px(calibration), picture);
    if (problem) throw BenchFault(*problem);
  }
  if (const auto problem = slip_problem(calibration, found, reading_rad, picture)) throw BenchFault(*problem);
}

}  // namespace station
