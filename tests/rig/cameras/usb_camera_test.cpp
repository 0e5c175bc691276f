// The real camera driver through libgphoto2's real USB driver, with a camera on the bus that another program holds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rig/devices/detect.h"
#include "tests/rig/cameras/gphoto_camera_fixture.h"

using testing::HasSubstr;

// Fault 15. On the network a camera turns the second one away; on USB the kernel does.
TEST(UsbCamera, ThatAnotherProgramHoldsIsSaidWithWhatToClose) {
  for (const char* port : {"usb:", "usb:001,004"}) {
    const std::string said = refusal([&] {
      rig::make_process_camera(
          {.command = {"/proc/self/exe", "camera-process"}, .camera = {.port = port, .width_px = 60, .height_px = 40}});
    });
    EXPECT_THAT(said, HasSubstr("Could not claim the USB device")) << port;
    EXPECT_THAT(said, HasSubstr("another program holds the camera; close")) << port;
    EXPECT_THAT(said, HasSubstr("gio mount -s gphoto2)")) << port;
    std::cout << "  " << said << "\n";
  }
}

TEST(UsbCamera, ThatIsNotThereIsSaidWithWhatToSet) {
  EXPECT_THAT(refusal([] {
                rig::make_process_camera({.command = {"/proc/self/exe", "camera-process"},
                                          .camera = {.port = "usb:001,009", .width_px = 60, .height_px = 40}});
              }),
              HasSubstr("USB Connection to PC Remote"));
}

TEST(UsbCamera, IsFoundByItsNumbers) {
  const auto found = rig::find_cameras();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].port, "usb:001,004");
  EXPECT_THAT(found[0].name, HasSubstr("ILCE-7M2"));
}
