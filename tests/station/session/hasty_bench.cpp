#include "tests/station/session/hasty_bench.h"

namespace station_test {
namespace {

using nlohmann::json;

void coarsen(json& sensor, json& lens) {
  constexpr int kSide_px = 4;
  for (const char* key : {"width_px", "height_px"}) sensor[key] = sensor[key].get<int>() / kSide_px;
  for (const char* key : {"focal_length_px", "principal_point_px"})
    for (json& value : lens[key]) value = value.get<double>() / kSide_px;
}

}  // namespace

json hasty_rig(json rig) {
  rig["simulation"]["samples_per_pixel"] = 1;
  rig["simulation"]["target_samples_per_pixel"] = 1;
  coarsen(rig["simulation"]["sensor"], rig["simulation"]["lens"]);
  return rig;
}

json hasty_calibration(json calibration) {
  coarsen(calibration["lens"], calibration["lens"]);
  calibration.erase("sensor");
  return calibration;
}

}  // namespace station_test
