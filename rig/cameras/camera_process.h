// The camera behind a process of its own, so that a crash or a hang of the camera library costs one picture at most.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rig/cameras/gphoto_camera.h"
#include "rig/devices/camera.h"

namespace rig {

struct CameraProcessSetup {
  std::vector<std::string> command;  // program and arguments of the process, which finds the socket as descriptor 3
  GphotoSetup camera;
  double answer_timeout_s = 40;  // added to the exposure time; libgphoto2 itself gives up after 35 s
};

// Connects at once. A process that died or hangs is replaced by a new one, and so is one whose connection to the camera
// broke. The new process sets the camera as it was, throws away pictures that still wait in it, and is asked the same
// question again. Errors: those of the camera; std::runtime_error when one question made the process end three times or
// hang twice.
std::unique_ptr<Camera> make_process_camera(const CameraProcessSetup& setup);

// The work of the camera process: answers the frames on `socket` until it is closed. Returns the exit status.
int run_camera_process(int socket, const std::function<std::unique_ptr<Camera>(const GphotoSetup&)>& open_camera);

}  // namespace rig
