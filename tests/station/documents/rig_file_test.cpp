// The keys of a rig file that say how its devices are reached.
#include "station/documents/rig_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/documents/degree.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/documents/refusal.h"

namespace station {
namespace {

using nlohmann::json;
using station_test::refusal;
using testing::HasSubstr;

json rig_document(const std::string& name) {
  return read_json_file(std::string(DATA_DIR) + "/rigs/" + name + ".json");
}

std::string said(json document, const std::string& pointer, const json& value) {
  document[json::json_pointer(pointer)] = value;
  return refusal([&] { parse_rig(document, "rig.json"); });
}

std::string said_without(json document, const std::string& object, const std::string& key) {
  document[object].erase(key);
  return refusal([&] { parse_rig(document, "rig.json"); });
}

}  // namespace

TEST(RigFile, MayNameTheHolderOfItsSpoolsWhichIsChecked) {
  json rig = rig_document("simulated");
  EXPECT_THAT(said(rig, "/holder/window_width_mm", 69), HasSubstr("holder.window_width_mm"));  // wider than the frame
  EXPECT_THAT(said(rig, "/holder/colour", "black"), HasSubstr("holder.colour"));
  rig.erase("holder");
  EXPECT_NO_THROW(parse_rig(rig, "rig.json"));
}

TEST(RigFileDevices, AreReadWithTheirUnits) {
  const RigFile rig = parse_rig(rig_document("grbl_sony_usb"), "rig.json");
  ASSERT_TRUE(rig.turntable_wire);
  EXPECT_EQ(rig.turntable_wire->port.usb_serial, "A50285BI");
  EXPECT_EQ(rig.turntable_wire->port.baud, 115200);
  EXPECT_EQ(rig.turntable_wire->controller.steps_per_deg, 40);
  EXPECT_EQ(rig.turntable_wire->controller.home_by, rig::HomeBy::home_switch);
  EXPECT_NEAR(rig.turntable_wire->stepper.backlash_rad, 1 * kDegree, 1e-12);
  EXPECT_NEAR(rig.turntable_wire->stepper.limit_rad, 2 * std::numbers::pi, 1e-12);
  ASSERT_TRUE(rig.camera_wire);
  EXPECT_EQ(rig.camera_wire->setup.port, "usb:");
  EXPECT_EQ(rig.camera_wire->setup.width_px, 6024);
}

// A link that is slow to reply is slow to greet as well.
TEST(RigFileDevices, AGreetingIsAwaitedAsLongAsAReplyAndFiveSecondsAtLeast) {
  json slow = rig_document("grbl_sony_usb");
  EXPECT_EQ(parse_rig(slow, "rig.json").turntable_wire->controller.banner_timeout_s, 5);
  slow["turntable_setup"]["reply_timeout_s"] = 20;
  EXPECT_EQ(parse_rig(slow, "rig.json").turntable_wire->controller.banner_timeout_s, 20);
}

TEST(RigFileDevices, MayHaveFirmwareThatWasBuiltToHomeOneAxis) {
  json grbl = rig_document("grbl_sony_usb");
  EXPECT_FALSE(parse_rig(grbl, "rig.json").turntable_wire->controller.homes_x_alone);
  grbl["turntable_setup"]["homing_cycle"] = "x_only";
  EXPECT_TRUE(parse_rig(grbl, "rig.json").turntable_wire->controller.homes_x_alone);
  EXPECT_THAT(said(grbl, "/turntable_setup/homing_cycle", "x"), HasSubstr("turntable_setup.homing_cycle"));
  EXPECT_THAT(said(rig_document("zaber_sony_usb"), "/turntable_setup/homing_cycle", "x_only"),
              HasSubstr("homing_cycle"));
}

TEST(RigFileDevices, AreRefusedWithTheKeyWhenTheyCannotBeMeant) {
  const json grbl = rig_document("grbl_sony_usb"), zaber = rig_document("zaber_sony_usb");
  EXPECT_THAT(said(grbl, "/turntable", "stepper"), HasSubstr("turntable"));
  EXPECT_THAT(said(grbl, "/turntable_setup/port", "/dev/ttyUSB0"), HasSubstr("keep one of the two"));
  EXPECT_THAT(said_without(grbl, "turntable_setup", "usb_serial"), HasSubstr("turntable_setup.port"));
  EXPECT_THAT(said(rig_document("grbl_sony_network"), "/turntable_setup/port", "COM3"),
              HasSubstr("expected a device such as /dev/ttyUSB0"));
  EXPECT_THAT(said(grbl, "/turntable_setup/steps_per_deg", 0), HasSubstr("turntable_setup.steps_per_deg"));
  EXPECT_THAT(said(grbl, "/turntable_setup/limit_deg", 6.28), HasSubstr("turntable_setup.limit_deg"));  // radians
  EXPECT_THAT(said(grbl, "/turntable_setup/reply_timeout_s", 2000), HasSubstr("reply_timeout_s"));      // ms
  EXPECT_THAT(said(grbl, "/turntable_setup/axis", 1), HasSubstr("axis"));                               // a Zaber's key
  EXPECT_THAT(said(zaber, "/turntable_setup/home", "here"), HasSubstr("expected \"switch\""));
  EXPECT_THAT(said(grbl, "/camera_connection/port", "/dev/video0"), HasSubstr("\"usb:\" (the only camera)"));
  EXPECT_THAT(said_without(grbl, "camera_connection", "width_px"), HasSubstr("camera_connection.width_px"));
  json wire = rig_document("simulated_wire_grbl");
  wire.erase("simulation");
  EXPECT_THAT(refusal([&] { parse_rig(wire, "rig.json"); }), HasSubstr("needs it"));
}

TEST(RigFileDevices, ASimulatedCameraIsOfOneOfThreeMakesAndItsLensMayHaveNoElectronicAperture) {
  json document = rig_document("simulated_wire_grbl");
  const RigFile sony = parse_rig(document, "rig.json");
  EXPECT_EQ(sony.simulation->camera_make, rig::CameraMake::sony);
  EXPECT_TRUE(sony.simulation->truth.lens.electronic_aperture);
  document["simulation"]["make"] = "nikon";
  document["simulation"]["lens"]["electronic_aperture"] = false;
  const RigFile nikon = parse_rig(document, "rig.json");
  EXPECT_EQ(nikon.simulation->camera_make, rig::CameraMake::nikon);
  EXPECT_FALSE(nikon.simulation->truth.lens.electronic_aperture);
  document["simulation"]["make"] = "canon";
  EXPECT_EQ(parse_rig(document, "rig.json").simulation->camera_make, rig::CameraMake::canon);
  EXPECT_THAT(said(document, "/simulation/make", "kodak"), HasSubstr("sony"));
}

}  // namespace station
