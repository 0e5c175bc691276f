// The camera in a process of its own, so that a crash or a hang of the camera library costs one picture at most.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rig/camera.h"
#include "rig/cameras/gphoto_camera.h"

namespace rig {

struct CameraProcessSetup {
  std::vector<std::string> command;  // program and arguments of the process; it finds the socket as descriptor 3
  GphotoSetup camera;
  double answer_timeout_s = 40;  // beside the exposure: libgphoto2 itself gives up after 35 s
};

// Connects at once. A process that died or hangs is ended and started again, and so is a connection that broke; what was
// asked is then asked a second time, with the settings of before, after what the camera had taken meanwhile was thrown
// away. Errors: those of the camera; std::runtime_error when the process fails twice in a row.
std::unique_ptr<Camera> make_process_camera(const CameraProcessSetup& setup);

// The process itself: answers frames on the socket until it is closed. Returns the exit status.
int run_camera_process(int socket, const std::function<std::unique_ptr<Camera>(const GphotoSetup&)>& open_camera);

}  // namespace rig
