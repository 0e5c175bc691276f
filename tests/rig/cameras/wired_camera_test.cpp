// The real camera driver, in its own process, against the simulated ILCE-7M2 by PTP/IP. What every make has to do is in
// camera_makes_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <limits>
#include <thread>

#include "rig/cameras/camera_process.h"
#include "tests/rig/cameras/gphoto_camera_fixture.h"

namespace {

using testing::HasSubstr;

}  // namespace

TEST_F(GphotoCamera, SaysWhoItIsAndWhichTimesItHas) {
  const auto camera = open();
  const rig::CameraIdentity found = camera->identity();
  EXPECT_EQ(found.make, "Sony Corporation");
  EXPECT_EQ(found.model, "ILCE-7M2");
  EXPECT_EQ(found.serial, "SIM1");
  const auto times_s = camera->shutter_times_s();
  EXPECT_EQ(times_s, wired.camera->shutter_times_s());
}

TEST_F(GphotoCamera, ASettingThatIsAcceptedAndNotDoneIsSeen) {
  const auto camera = open();
  wired.body->set_condition({.shutter_locked = true});
  EXPECT_THAT(refusal([&] { camera->configure({.exposure_s = 2, .iso = 100, .f_number = 8}); }),
              testing::AllOf(HasSubstr("set its shutterspeed to 2 and stays at 1/4"), HasSubstr("dial to M")));
}

TEST_F(GphotoCamera, ACardThatBecomesFullIsSaidAndTheNextPictureComesWhenItIsEmptied) {
  const auto camera = open();
  camera->capture();
  wired.body->set_condition({.store_full = true});
  EXPECT_THAT(refusal([&] { camera->capture(); }), HasSubstr("card is full; empty the card, then resume"));
  wired.body->set_condition({});
  EXPECT_TRUE(delivers_what_was_made(*camera));
}

TEST_F(GphotoCamera, AStalePictureIsRefused) {
  const auto camera = open();
  camera->capture();
  wired.body->set_condition({.repeats_last_picture = true});
  EXPECT_THAT(refusal([&] { camera->capture(); }), HasSubstr("delivered before"));
  wired.body->set_condition({});
  EXPECT_TRUE(delivers_what_was_made(*camera));
}

TEST_F(GphotoCamera, APictureThatWaitsFromBeforeIsDrainedAndNotTakenForTheNextOne) {
  const auto camera = open();
  camera->configure({.exposure_s = 0.25, .iso = 100, .f_number = 8});
  wired.body->handle({.code = 0x9207, .parameters = {0xd2c2}, .data = std::string("\2\0", 2)});  // somebody's finger
  while (wired.body->waiting_pictures() == 0) std::this_thread::yield();
  const rig::Picture picture = camera->capture();
  ASSERT_EQ(wired.recorded.count(), 2u);
  EXPECT_EQ(picture.bytes, wired.recorded.last().bytes);
}

TEST_F(GphotoCamera, NobodyThereIsSaidWithWhatToCheck) {
  wired.server->unplug();
  EXPECT_THAT(refusal([this] { open(); }), HasSubstr("check its cable"));
}

TEST_F(GphotoCamera, AProcessThatHangsIsEndedAndStartedAgain) {
  const auto camera = open(6 * kPatience);  // s; a process starts in less
  camera->capture();
  for (const pid_t child : children()) kill(child, SIGSTOP);
  EXPECT_TRUE(delivers_what_was_made(*camera));
}

TEST_F(GphotoCamera, ExposuresThatAreNoNumbersAreRefused) {
  const auto camera = open();
  for (const double exposure_s : {std::numeric_limits<double>::quiet_NaN(), -1.0, 0.0}) {
    EXPECT_THAT(refusal([&] { camera->configure({.exposure_s = exposure_s, .iso = 100, .f_number = 8}); }),
                HasSubstr("must be"));
  }
}
