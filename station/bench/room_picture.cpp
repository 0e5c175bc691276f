#include "station/bench/room_picture.h"

#include <optional>

#include "station/bench/exposure.h"
#include "station/bench/metering.h"

namespace station {
namespace {
constexpr int kMostTestPictures = 8;
constexpr double kFirst_s = 0.5;
}  // namespace

RoomPicture take_room_picture(rig::Camera& camera, double level, double f_number) {
  RoomPicture room;
  const ExposureAim aim{.level = level};
  const Metering metering = meter_exposure(
      camera, {}, {.exposure_s = kFirst_s, .f_number = f_number},
      [&](const PlanStep&, const rig::Picture& test) -> ExposureChoice {
        room.picture = calibration::read_sensor_bytes(test.bytes, "the test picture");
        const auto next = next_exposure_s(room.picture, {}, aim);
        return {.exposure_s = next.value_or(room.picture.exposure_s), .done = !next};
      },
      kMostTestPictures, [] {});
  room.exposed = metering.converged;
  return room;
}

}  // namespace station
