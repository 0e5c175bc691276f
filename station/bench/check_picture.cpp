#include "station/bench/check_picture.h"

#include <optional>
#include <sstream>

#include "calibration/develop/linear_grey.h"
#include "station/bench/bench_reading.h"
#include "station/bench/calibration_validity.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/exposure.h"
#include "station/bench/picture_measures.h"
#include "station/bench/room_picture.h"
#include "station/documents/degree.h"

namespace station {
namespace {

constexpr double kMostBlur_px = 1.2;  // of edges in focus: they then turn from dark to light within three pixels
constexpr int kFewestTableTags = 1;

template <typename... Parts>
std::string words(const Parts&... parts) {
  std::ostringstream text;
  text.precision(3);
  (text << ... << parts);
  return text.str();
}

rig::ContractRow tags_row(const calibration::TagLayout& layout, const std::string& where, int fewest,
                          const calibration::TagObservation& seen) {
  const long count = calibration::tags_seen(layout, seen);
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

std::vector<rig::ContractRow> check_picture(const RigDevices& devices, const RigFile& rig,
                                            const RigCalibration& calibration) {
  if (devices.bench) rig::make_simulated_operator(*devices.bench)->arrange({.room_light = true});
  devices.turntable->home();
  const RoomPicture room = take_room_picture(*devices.camera, rig.target_level, calibration.camera.f_number);
  const calibration::SensorPicture& picture = room.picture;
  require_same_camera(calibration, picture, "the test picture");
  const cv::Mat1f grey = calibration::linear_grey(picture);
  const calibration::TagObservation seen = calibration::detect_tags(grey);
  const double level = bright_level(picture, {}, ExposureAim{}.percentile);
  const std::optional<double> blur_px = edge_blur_px(grey, seen);
  const bool sharp = blur_px && *blur_px <= kMostBlur_px;
  return {
      {"an exposure is found", room.exposed,
       words(picture.exposure_s, " s, brightest at ", 100 * level, " % of the range",
             room.exposed ? "" : "; see that the room light is on and does not flicker")},
      {"the picture is in focus", sharp,
       (blur_px ? words("edges of tags are blurred by ", *blur_px, " px")
                : "no tag is seen that is large enough to tell") +
           (sharp ? "" : "; focus on the holder, tape the ring and calibrate again")},
      tags_row(rig.platform_ring, "on the platform", kFewestRingTags, seen),
      tags_row(rig.table_tags, "on the table", kFewestTableTags, seen),
      stands_row(calibration, rig, seen, devices.turntable->angle_rad()),
  };
}

}  // namespace station
