// A camera that libgphoto2 drives, over USB or network: the Sony Alpha 7 II and its like.
//
// The library may hang, crash or keep a stale picture; a program that must live on runs this in a process of its own
// (camera_process.h). Every setting is read back and compared as a number; a picture is believed only when it is none of
// those delivered before.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "rig/camera.h"

namespace rig {

struct GphotoSetup {
  std::string port;  // "usb:" for the only one, "usb:001,004", "ptpip:192.168.1.5", "ptpip:127.0.0.1:15740:15740"
  int width_px = 0, height_px = 0;         // of its raw pictures, which the wire does not tell
  double shortest_shutter_s = 1.0 / 8000;  // libgphoto2 offers shorter ones that the camera does not have
  int least_battery_percent = 10;
};

// The connection broke or answered nothing of use, and nobody knows whether the camera did what was asked.
struct CameraLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Connects and looks whether the camera is ready: mode dial at M, manual focus, battery, card; sets RAW. Errors:
// std::runtime_error with the menu entry or the cable to look at. SIGPIPE must be ignored by the program.
std::unique_ptr<Camera> make_gphoto_camera(const GphotoSetup& setup);

}  // namespace rig
