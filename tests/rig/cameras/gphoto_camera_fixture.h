// The real camera driver, in its own process, connected to a simulated camera.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "rig/cameras/camera_process.h"
#include "tests/rig/cameras/wired_camera.h"
#include "tests/support/refusal.h"

// The factor by which programs with a sanitizer take longer; even under load none of their processes may be taken for
// one that hangs.
#ifdef THREADSTATION_SANITIZED
inline constexpr double kPatience = 15;
#else
inline constexpr double kPatience = 1;
#endif

// The child processes of this program that are alive.
inline std::vector<pid_t> children() {
  std::vector<pid_t> found;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream list(task.path() / "children");
    for (pid_t one = 0; list >> one;) found.push_back(one);
  }
  return found;
}

// The number of files that this program has open.
inline std::size_t open_descriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

struct GphotoCamera : testing::Test {
  explicit GphotoCamera(rig::CameraMake make = rig::CameraMake::sony) : wired({}, {}, make) {}
  std::unique_ptr<rig::Camera> open(double answer_timeout_s = 40 * kPatience) const {
    return rig::make_process_camera({.command = {"/proc/self/exe", "camera-process"},
                                     .camera = {.port = wired.port(), .width_px = 60, .height_px = 40},
                                     .answer_timeout_s = answer_timeout_s});
  }
  std::string said_with(const rig::BodyCondition& condition) {
    wired.body->set_condition(condition);
    return refusal([this] { open(); });
  }
  bool delivers_what_was_made(rig::Camera& camera) const {
    const rig::Picture picture = camera.capture();
    return picture.bytes == wired.recorded.last().bytes;
  }
  WiredCamera wired;
};
