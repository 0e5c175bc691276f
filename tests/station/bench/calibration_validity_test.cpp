#include "station/bench/calibration_validity.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "station/bench/camera_adapter.h"
#include "station/bench/metering.h"
#include "station/documents/reader.h"
#include "tests/places.h"

namespace station {
namespace {

using testing::HasSubstr;

template <typename Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

struct Case {
  RigCalibration calibration;
  RigFile rig;
};

Case matching() {
  Case c;
  c.rig.name = c.calibration.rig_name = "bench";
  c.rig.lens_name = c.calibration.camera.lens = "90 mm macro";
  c.rig.focus = c.calibration.camera.focus = "taped at 0.6 m";
  c.rig.calibration_valid_days = 30;
  c.calibration.utc = "2026-11-01T08:00:00.000Z";
  c.calibration.camera.model = "ILCE-7M2";
  c.calibration.camera.serial = "123";
  c.calibration.lens.lens.width_px = 600;
  c.calibration.lens.lens.height_px = 400;
  c.calibration.platform.gates = {calibration::at_most("axis, deg", 0.01, 0.02, "take more angles")};
  return c;
}

calibration::SensorPicture matching_picture() {
  calibration::SensorPicture picture;
  picture.mosaic = cv::Mat1w(400, 600);
  picture.model = "ILCE-7M2";
  picture.serial = "123";
  picture.f_number = 8;
  return picture;
}

std::string refusal(const Case& c, const std::string& now = "2026-11-21T08:00:00Z", bool accept = false) {
  return message_of([&] { require_valid(c.calibration, c.rig, now, accept); });
}

std::string refusal(const Case& c, const calibration::SensorPicture& picture) {
  return message_of([&] { require_same_camera(c.calibration, picture, "picture 1"); });
}

TEST(CalibrationValidity, ACalibrationOfThisRigAndCameraIsTaken) {
  EXPECT_EQ(refusal(matching()), "");
  EXPECT_EQ(refusal(matching(), matching_picture()), "");
}

TEST(CalibrationValidity, AnotherRigLensOrFocusIsRefusedByName) {
  Case c = matching();
  c.rig.name = "other";
  EXPECT_THAT(refusal(c), HasSubstr("rig \"bench\", this is \"other\""));
  c = matching();
  c.rig.lens_name = "50 mm";
  EXPECT_THAT(refusal(c), HasSubstr("lens \"90 mm macro\", this is \"50 mm\""));
  c = matching();
  c.rig.focus = "taped at 0.7 m";
  EXPECT_THAT(refusal(c), HasSubstr("focus"));
}

TEST(CalibrationValidity, AnotherBodyPictureSizeOrApertureIsRefusedByName) {
  calibration::SensorPicture picture = matching_picture();
  picture.serial = "124";
  EXPECT_THAT(refusal(matching(), picture), HasSubstr("camera \"ILCE-7M2 123\", this is \"ILCE-7M2 124 (picture 1)\""));
  picture = matching_picture();
  picture.mosaic = cv::Mat1w(300, 600);
  EXPECT_THAT(refusal(matching(), picture), HasSubstr("600 x 400"));
  picture = matching_picture();
  picture.f_number = 5.6;
  EXPECT_THAT(refusal(matching(), picture), HasSubstr("aperture \"f/8.0\", this is \"f/5.6"));
}

TEST(CalibrationValidity, AFileThatDoesNotTellItsApertureIsTaken) {
  calibration::SensorPicture picture = matching_picture();
  picture.f_number = 0;
  EXPECT_EQ(refusal(matching(), picture), "");
  EXPECT_EQ(f_number_of(picture), 8);
  EXPECT_TRUE(same_settings({.f_number = 5.6}, {.f_number = 0}));
  EXPECT_FALSE(same_settings({.f_number = 5.6}, {.f_number = 8}));
}

TEST(CalibrationValidity, AnOldCalibrationIsRefusedAndADateThatIsNoneToo) {
  EXPECT_THAT(refusal(matching(), "2026-12-02T08:00:00Z"), HasSubstr("31 days old"));
  EXPECT_EQ(refusal(matching(), "2026-11-30T08:00:00Z"), "");
  Case c = matching();
  c.calibration.utc = "yesterday";
  EXPECT_THAT(refusal(c), HasSubstr("\"yesterday\" is no date"));
  EXPECT_DOUBLE_EQ(days_between("2026-02-28T12:00:00Z", "2026-03-01T18:00:00Z"), 1.25);
  EXPECT_DOUBLE_EQ(86400 * days_between("2026-02-28T12:00:00.250Z", "2026-02-28T12:00:02.5Z"), 2.25);
}

TEST(CalibrationValidity, AFailedGateIsRefusedWithItsReasonUnlessItIsAccepted) {
  Case c = matching();
  c.calibration.platform.gates.push_back(calibration::at_most("corners, px", 0.9, 0.5, "press the prints flat"));
  EXPECT_THAT(refusal(c), HasSubstr("corners, px: 0.9, limit 0.5 (press the prints flat)"));
  EXPECT_EQ(refusal(c, "2026-11-21T08:00:00Z", true), "");
}

// The simulated bench does not age.
TEST(CalibrationValidity, TheReadyCalibrationIsOfTheReadyRigForYears) {
  EXPECT_NO_THROW(require_valid(read_calibration(std::string(DATA_DIR) + "/calibrations/simulated.json"),
                                read_rig(std::string(DATA_DIR) + "/rigs/simulated.json"), "2036-01-01T00:00:00Z",
                                false));
}

// Not always called calibration.json.
}  // namespace
}  // namespace station
