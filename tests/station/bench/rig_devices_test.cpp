// Devices that are opened as a rig file names them.
#include "station/bench/rig_devices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

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

TEST(OpenRig, OnASimulatedBenchAPersonMayPractise) {
  json document = rig_document("simulated");
  document["operator"] = "console";
  document["turntable"] = "manual";
  std::istringstream in("\n\n\n");
  std::ostringstream out;
  const auto asked = rig::make_person_at_terminal(in, out);
  const RigDevices devices = open_rig(parse_rig(document, "rig.json"), {}, asked.get());
  devices.person->arrange({.lamp = rig::Lamp::back});
  devices.turntable->home();
  devices.turntable->move_to(1);
  EXPECT_THAT(out.str(), HasSubstr("Put the flashlight behind the platform and switch it on."));
  EXPECT_THAT(out.str(), HasSubstr("Turn the platform to 57.3 deg"));
  EXPECT_EQ(devices.bench->state().arrangement.lamp, rig::Lamp::back);
  EXPECT_NEAR(devices.bench->state().platform_angle_rad, 1, 0.01);
  EXPECT_THAT(refusal([&] { open_rig(parse_rig(document, "rig.json"), {}, nullptr); }), HasSubstr("needs a person"));
}

TEST(RigDevices, OfTwoWorldsAreRefused) {
  std::istringstream in;
  std::ostringstream out;
  const auto asked = rig::make_person_at_terminal(in, out);
  json mixed = rig_document("grbl_sony_usb");
  mixed["turntable"] = "simulated";
  mixed["simulation"] = rig_document("simulated").at("simulation");
  mixed.erase("turntable_setup");
  EXPECT_THAT(refusal([&] { open_rig(parse_rig(mixed, "rig.json"), std::nullopt, asked.get()); }),
              HasSubstr("the pictures would not turn with it"));
  EXPECT_THAT(refusal([&] { open_rig(parse_rig(mixed, "rig.json"), std::nullopt, nullptr); }),
              HasSubstr("run without --unattended"));
  json real = rig_document("grbl_sony_usb");
  real["operator"] = "simulated";
  EXPECT_THAT(refusal([&] { open_rig(parse_rig(real, "rig.json"), std::nullopt, asked.get()); }),
              HasSubstr("write \"operator\": \"console\""));
}

}  // namespace
}  // namespace station
