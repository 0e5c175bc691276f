// A camera driven by libgphoto2 over USB or network: Sony Alpha, Canon EOS and Nikon, known by the settings that the
// camera offers (make_settings.h).
//
// The library may hang or crash, so a program that must live on runs this camera in a process of its own
// (camera_process.h). Every setting is read back and compared as a number. The library may also deliver an old picture
// again, so a picture is accepted only when the same bytes were not delivered before. With a lens whose aperture the
// camera cannot set, the f-number of settings and pictures is the one that was asked for, to which a person sets the
// lens.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "rig/devices/camera.h"

namespace rig {

struct GphotoSetup {
  std::string port;  // "usb:" (the only camera), "usb:001,004", "ptpip:192.168.1.5", "ptpip:127.0.0.1:15740:15740"
  int width_px = 0, height_px = 0;         // size of the raw pictures, which the protocol does not tell
  double shortest_shutter_s = 1.0 / 8000;  // libgphoto2 also offers shorter times, which the camera does not have
  int least_battery_percent = 10;
};

// The connection broke or brought no usable answer, and nobody knows whether the camera did what was asked.
struct CameraLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Connects to the camera, checks that it is ready (mode dial at M, manual focus, battery, card) and sets RAW. Errors:
// std::runtime_error that names the menu entry or the cable to look at, or says what the camera lacks. The program must
// ignore SIGPIPE.
std::unique_ptr<Camera> make_gphoto_camera(const GphotoSetup& setup);

}  // namespace rig
