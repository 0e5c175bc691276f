// What the camera process costs when it dies: fifty deaths, at moments drawn with a fixed seed.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <random>
#include <thread>

#include "tests/rig/cameras/gphoto_camera_fixture.h"

TEST_F(GphotoCamera, AProcessThatIsKilledAtAnyMomentCostsNoPicture) {
  const auto camera = open();
  camera->configure({.exposure_s = 0.25, .iso = 100, .f_number = 8});
  camera->capture();
  const std::size_t before = open_descriptors();
  std::mt19937 random(7);
  std::uniform_int_distribution<int> moment_ms(0, 400);
  for (int run = 0; run < 50; ++run) {
    std::thread killer([&, wait = moment_ms(random)] {
      std::this_thread::sleep_for(std::chrono::milliseconds(wait));
      for (const pid_t child : children()) kill(child, SIGKILL);
    });
    try {
      const rig::Picture picture = camera->capture();
      EXPECT_TRUE(picture.bytes == wired.recorded.last().bytes) << run;
      EXPECT_DOUBLE_EQ(picture.settings.exposure_s, 0.25);
    } catch (const std::exception& error) {
      ADD_FAILURE() << "run " << run << ": " << error.what();
    }
    killer.join();
  }
  camera->capture();
  EXPECT_EQ(open_descriptors(), before);
}
