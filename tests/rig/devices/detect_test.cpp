#include "rig/devices/detect.h"

#include <gtest/gtest.h>

TEST(Detect, ListsWhatIsThereInSilence) {
  testing::internal::CaptureStderr();
  const auto devices = rig::find_devices();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  for (const rig::FoundDevice& device : devices) {
    EXPECT_TRUE(device.kind == "camera" || device.kind == "serial port");
    EXPECT_FALSE(device.port.empty());
    EXPECT_FALSE(device.believed_to_be.empty());
  }
}

TEST(Detect, StandardErrorSpeaksAgainAfterwards) {
  testing::internal::CaptureStderr();
  rig::find_cameras();
  fputs("still here", stderr);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "still here");
}

TEST(Detect, BelievesBoardsWithKnownMakersToBeTurntables) {
  EXPECT_EQ(rig::believed_serial_device(0x2341), "perhaps a GRBL turntable (Arduino)");
  EXPECT_EQ(rig::believed_serial_device(-1), "a port of the computer itself");
  EXPECT_EQ(rig::believed_serial_device(0xbeef), "a USB serial device");
}
