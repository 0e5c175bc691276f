// What a GRBL turntable's settings are held against, without a wire.
#include "rig/turntables/grbl_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "tests/rig/turntables/grbl_lines.h"
#include "tests/support/refusal.h"

namespace {

using rig::GrblFirmware;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

rig::ControllerSetup setup(rig::HomeBy home_by = rig::HomeBy::home_switch) {
  rig::ControllerSetup setup;
  setup.steps_per_deg = 40;
  setup.home_by = home_by;
  return setup;
}

GrblFirmware with_single_axes() {
  return rig::grbl_firmware(kBanner, {"VER:1.1h.20190830:", "OPT:VH,15,128"});
}

// As they come from the maker, by the interface's documentation.
rig::GrblSettings as_they_come() {
  return {{0, 10},     {1, 25},    {2, 0},  {3, 0},  {4, 0},     {5, 0},     {6, 0},    {10, 1},   {11, 0.01},
          {12, 0.002}, {13, 0},    {20, 0}, {21, 0}, {22, 0},    {23, 0},    {24, 25},  {25, 500}, {26, 250},
          {27, 1},     {30, 1000}, {31, 0}, {32, 0}, {100, 250}, {110, 500}, {120, 10}, {130, 200}};
}

rig::GrblSettings right() {
  rig::GrblSettings settings = as_they_come();
  for (const auto& [number, value] : rig::GrblSettings{{1, 255}, {22, 1}, {25, 480}, {100, 40}, {130, 360}})
    settings[number] = value;
  return settings;
}

std::string said(const rig::GrblSettings& settings, const rig::ControllerSetup& needs = setup(),
                 const GrblFirmware& firmware = with_single_axes()) {
  return refusal([&] { rig::require_grbl_settings(settings, needs, firmware); });
}

std::string said_with(int number, double value) {
  rig::GrblSettings settings = right();
  settings[number] = value;
  return said(settings);
}

}  // namespace

TEST(GrblSettingsNeeded, OfAControllerAsItComesAreAllSaidAtOnce) {
  EXPECT_EQ(said(right()), "(accepted)");
  const std::string message = said(as_they_come());
  EXPECT_THAT(message,
              HasSubstr("type: $1=255, $22=1, $25=480, $100=40, $130=360, or let \"threadstation turntable set-up\""));
  EXPECT_THAT(message, AllOf(HasSubstr("$100=250 (steps per degree: 40 in the rig file)"), Not(HasSubstr("\n"))));
}

TEST(GrblSettingsNeeded, ThatOnlyTheHomeSwitchNeedsAreNotAskedForWithoutOne) {
  EXPECT_THAT(said(as_they_come(), setup(rig::HomeBy::here)), HasSubstr("type: $1=255, $100=40, or let"));
}

TEST(GrblSettingsNeeded, AreEachRefusedBesideTheirLimits) {
  for (const auto& [number, value] : rig::GrblSettings{{1, 254},
                                                       {13, 1},
                                                       {20, 1},
                                                       {21, 1},
                                                       {22, 0},
                                                       {32, 1},
                                                       {100, 40.01},
                                                       {130, 359},
                                                       {24, 0},
                                                       {24, 481},
                                                       {25, 0},
                                                       {25, 481}})
    EXPECT_THAT(said_with(number, value), HasSubstr("type: $" + std::to_string(number) + "=")) << value;
  for (const auto& [number, value] : rig::GrblSettings{{100, 40.001}, {130, 1000}, {24, 0.5}, {25, 480}})
    EXPECT_EQ(said_with(number, value), "(accepted)") << number;
  // 480 deg/min: what $120 = 10 deg/s^2 can stop within 4 degrees; $110 allows 500.
  EXPECT_THAT(said_with(24, 0), HasSubstr("type: $24=48,"));
  EXPECT_THAT(said_with(25, 900), HasSubstr("type: $25=480,"));
  EXPECT_THAT(said_with(110, 300), HasSubstr("type: $25=300,"));
}

TEST(GrblSettingsNeeded, ThatAFirmwareDoesNotHaveAreNotAskedFor) {
  const GrblFirmware fluidnc = rig::grbl_firmware("Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]", {"OPT:MPHS"});
  EXPECT_EQ(said({{10, 1}, {22, 1}, {100, 40}, {110, 5000}, {130, 360}}, setup(), fluidnc), "(accepted)");
  EXPECT_THAT(said({{10, 1}, {22, 1}, {100, 80}, {130, 360}}, setup(), fluidnc), HasSubstr("config.yaml"));
}

TEST(GrblHoming, IsOfOneAxisWhereTheFirmwareKnowsHow) {
  EXPECT_EQ(rig::grbl_homing_command(setup(), with_single_axes()), "$HX");
  const GrblFirmware as_it_comes = rig::grbl_firmware(kBanner, {"VER:1.1h.20190830:", "OPT:V,15,128"});
  EXPECT_EQ(rig::grbl_homing_command(setup(), as_it_comes), std::nullopt);
  rig::ControllerSetup declared = setup();
  declared.homes_x_alone = true;
  EXPECT_EQ(rig::grbl_homing_command(declared, as_it_comes), "$H");
  EXPECT_EQ(rig::grbl_homing_command(declared, with_single_axes()), "$HX");
  EXPECT_EQ(said(right(), declared, as_it_comes), "(accepted)");
  EXPECT_EQ(said(right(), setup(rig::HomeBy::here), as_it_comes), "(accepted)");
  EXPECT_THAT(said(right(), setup(), as_it_comes),
              AllOf(HasSubstr("homes Z first"), HasSubstr("#define HOMING_CYCLE_0 (1<<X_AXIS)"),
                    HasSubstr("\"homing_cycle\": \"x_only\""), HasSubstr("\"home\": \"here\""), Not(HasSubstr("\n"))));
  EXPECT_THAT(said(as_they_come(), setup(), as_it_comes), AllOf(HasSubstr("$130=360"), HasSubstr("homes Z first")));
}

// grblHAL: $22 holds bits, of which the second one makes $HX known.
TEST(GrblHoming, OfGrblhalNeedsABitOfItsHomingSetting) {
  const GrblFirmware grblhal = rig::grbl_firmware("GrblHAL 1.1f ['$' or '$HELP' for help]", {"OPT:VN,35,1024,3,0"});
  EXPECT_EQ(grblhal.kind, GrblFirmware::Kind::grblhal);
  EXPECT_EQ(rig::grbl_homing_command(setup(), grblhal), "$HX");
  rig::GrblSettings settings = right();
  settings[1] = 25;  // means something else there
  EXPECT_THAT(said(settings, setup(), grblhal), HasSubstr("type: $22=3, or let"));
  settings[22] = 7;
  EXPECT_EQ(said(settings, setup(), grblhal), "(accepted)");
}

TEST(GrblHoming, IsNotTakenFromALetterBehindTheOptions) {
  EXPECT_FALSE(rig::grbl_firmware(kBanner, {"VER:1.1h.20190830:H", "OPT:V,H,128"}).homes_single_axis);
}

TEST(GrblNumbers, AreTypedWithoutNeedlessDigits) {
  EXPECT_EQ(rig::grbl_setting_line(100, 40), "$100=40");
  EXPECT_EQ(rig::grbl_setting_line(100, 4266.666667), "$100=4266.667");
  EXPECT_EQ(rig::grbl_setting_line(24, 0.5), "$24=0.5");
  EXPECT_EQ(rig::grbl_setting_line(20, 0), "$20=0");
}
