// A picture of the bench in the room's light, exposed by test pictures.
#pragma once

#include "calibration/sensor/sensor_file.h"
#include "rig/devices/camera.h"

namespace station {

struct RoomPicture {
  calibration::SensorPicture picture;
  bool exposed = false;  // false: no exposure was found in which its brightest part reaches the level
};

// `level`: where the brightest part should lie (1 = white). Errors: those of the camera and of reading its file.
RoomPicture take_room_picture(rig::Camera& camera, double level, double f_number);

}  // namespace station
