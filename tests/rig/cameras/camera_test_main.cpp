// This test program is also the camera process that its tests start.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstring>

#include "rig/cameras/camera_process.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "camera-process") == 0)
    return rig::run_camera_process(3, rig::make_gphoto_camera);
  const rlimit no_core{.rlim_cur = 0, .rlim_max = 0};  // processes are made to crash here
  setrlimit(RLIMIT_CORE, &no_core);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
