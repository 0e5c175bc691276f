// The real camera driver, and Debian's gphoto2 command, against simulated cameras of every make by PTP/IP.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "rig/devices/device_contract.h"
#include "tests/rig/cameras/gphoto2_command.h"
#include "tests/rig/cameras/gphoto_camera_fixture.h"
#include "tests/rig/simulated/raw_reader.h"

namespace {

using rig::CameraMake;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// What a camera of the make is called, offers, and tells a person.
struct Expected {
  const char *manufacturer, *model, *extension, *file_make, *file_model;
  const char *shutter, *aperture, *quality, *raw, *raw_and_jpeg;
  const char *mode_menu, *focus_menu;
  rig::PtpRequest somebody_presses_the_button;
  std::vector<std::pair<std::uint16_t, const char*>> needed;  // properties and their settings' names
};

Expected expected(CameraMake make) {
  switch (make) {
    case CameraMake::canon:
      return {"Canon Inc.",
              "Canon EOS 6D",
              "cr2",
              "Canon",
              "EOS 6D",
              "shutterspeed",
              "aperture",
              "imageformat",
              "RAW",
              "RAW + Large Fine JPEG",
              "autoexposuremode is \"AV\" and has to be \"Manual\"; set the mode dial on its top to M",
              "the switch on the lens to MF",
              {.code = 0x9128, .parameters = {2, 0}, .data = {}},
              {{0xd102, "shutterspeed"},
               {0xd103, "iso"},
               {0xd120, "imageformat"},
               {0xd105, "autoexposuremode"},
               {0xd108, "focusmode"}}};
    case CameraMake::nikon:
      return {"Nikon Corporation",
              "D750",
              "nef",
              "Nikon",
              "D750",
              "shutterspeed2",
              "f-number",
              "imagequality",
              "NEF (Raw)",
              "NEF+Fine",
              "expprogram is \"A\" and has to be \"M\"; set the mode dial on its top to M",
              "the lever beside the lens to M",
              {.code = 0x9207, .parameters = {0xffffffff, 1}, .data = {}},
              {{0x500f, "iso"}, {0x5004, "imagequality"}, {0x500e, "expprogram"}, {0x500a, "focusmode"}}};
    case CameraMake::sony:
      break;
  }
  return {"Sony Corporation",
          "ILCE-7M2",
          "arw",
          "Sony",
          "ILCE-7M2",
          "shutterspeed",
          "f-number",
          "imagequality",
          "RAW",
          "RAW+JPEG (Fine)",
          "expprogram is \"A\" and has to be \"M\"; set the mode dial on its top to M",
          "MENU > Focus Mode > MF",
          {.code = 0x9207, .parameters = {0xd2c2}, .data = std::string("\2\0", 2)},
          {{0xd20d, "shutterspeed"},
           {0xd21e, "iso"},
           {0x5004, "imagequality"},
           {0x500e, "expprogram"},
           {0x500a, "focusmode"}}};
}

struct CameraMakes : GphotoCamera, testing::WithParamInterface<CameraMake> {
  CameraMakes() : GphotoCamera(GetParam()), make(expected(GetParam())) {}
  const Expected make;
};

std::string name_of(const testing::TestParamInfo<CameraMake>& make) {
  return make.param == CameraMake::sony ? "Sony" : make.param == CameraMake::canon ? "Canon" : "Nikon";
}

INSTANTIATE_TEST_SUITE_P(All, CameraMakes, testing::Values(CameraMake::sony, CameraMake::canon, CameraMake::nikon),
                         name_of);

}  // namespace

TEST_P(CameraMakes, KeepTheContractOfCameras) {
  const auto camera = open();
  for (const rig::ContractRow& row : rig::check_camera(*camera))
    EXPECT_TRUE(row.passed) << row.name << ": " << row.what;
}

TEST_P(CameraMakes, SayWhoTheyAreAndWhichTimesTheyHave) {
  const auto camera = open();
  const rig::CameraIdentity found = camera->identity();
  EXPECT_EQ(found.make, make.manufacturer);
  EXPECT_EQ(found.model, make.model);
  EXPECT_EQ(found.serial, "SIM1");
  const auto times_s = camera->shutter_times_s();
  const auto known_s = wired.camera->shutter_times_s();
  ASSERT_EQ(times_s.size(), known_s.size());
  // Canon's engraved numbers are rounded: 0.3 s, 10.3 s, 20 s.
  for (std::size_t i = 0; i < times_s.size(); ++i) EXPECT_NEAR(times_s[i] / known_s[i], 1, 0.11) << times_s[i];
}

TEST_P(CameraMakes, DeliverTheBytesThatTheyMade) {
  const auto camera = open();
  for (const double exposure_s : {1 / 60.0, 0.5, 2.5}) {
    const rig::CameraSettings wanted{.exposure_s = exposure_s, .iso = 200, .f_number = 5.6};
    camera->configure(wanted);
    const rig::Picture picture = camera->capture();
    EXPECT_EQ(picture.extension, make.extension);
    EXPECT_DOUBLE_EQ(picture.settings.exposure_s, exposure_s);
    EXPECT_EQ(picture.settings.f_number, 5.6);
    const rig::Picture made = wired.recorded.last();
    EXPECT_EQ(picture.bytes, made.bytes);
    EXPECT_DOUBLE_EQ(made.settings.exposure_s, exposure_s);
    EXPECT_EQ(made.settings.iso, 200);
    EXPECT_EQ(made.settings.f_number, 5.6);
    const ReadRaw read = read_raw(picture.bytes);
    EXPECT_EQ(read.make, make.file_make);
    EXPECT_EQ(read.model, make.file_model);
  }
}

TEST_P(CameraMakes, SetTheLowestAndHighestOfEverySetting) {
  const auto camera = open();
  const auto times_s = camera->shutter_times_s();
  for (const rig::CameraSettings& wanted :
       {rig::CameraSettings{.exposure_s = times_s.front(), .iso = 50, .f_number = 2.8},
        rig::CameraSettings{.exposure_s = times_s.back(), .iso = 25600, .f_number = 22}}) {
    const rig::CameraSettings set = camera->configure(wanted);
    EXPECT_DOUBLE_EQ(set.exposure_s, wanted.exposure_s);
    EXPECT_EQ(set.iso, wanted.iso);
    EXPECT_EQ(set.f_number, wanted.f_number);
  }
}

TEST_P(CameraMakes, APreflightThatFailsNamesTheMenuOfTheMake) {
  EXPECT_THAT(said_with({.exposure_program = 3}), HasSubstr(make.mode_menu));
  EXPECT_THAT(said_with({.focus_mode = 2}), HasSubstr(make.focus_menu));
  EXPECT_THAT(said_with({.battery_percent = 4}), HasSubstr("charge it"));
  EXPECT_THAT(said_with({.store_full = true}), HasSubstr("empty the card"));
  EXPECT_EQ(said_with({}), "(accepted)");
}

// The aperture is then set by hand, on the lens.
TEST_P(CameraMakes, ALensWithoutAnElectronicApertureServesAndWhatWasAskedForIsRecorded) {
  for (const rig::BodyCondition& condition : {rig::BodyCondition{.missing = {rig::aperture_property(GetParam())}},
                                              rig::BodyCondition{.no_aperture_choices = true}}) {
    wired.body->set_condition(condition);
    const auto camera = open();
    EXPECT_EQ(camera->capture().settings.f_number, 8) << "nobody has asked yet";
    EXPECT_EQ(camera->configure({.exposure_s = 0.5, .iso = 200, .f_number = 5.6}).f_number, 5.6);
    const rig::Picture picture = camera->capture();
    EXPECT_EQ(picture.bytes, wired.recorded.last().bytes);
    EXPECT_EQ(picture.settings.f_number, 5.6);
    EXPECT_EQ(picture.settings.iso, 200);
    for (const rig::ContractRow& row : rig::check_camera(*camera))
      EXPECT_TRUE(row.passed) << row.name << ": " << row.what;
  }
}

TEST_P(CameraMakes, AnyOtherSettingThatIsMissingIsNamed) {
  for (const auto& [property, name] : make.needed) {
    EXPECT_THAT(said_with({.missing = {property}}),
                AllOf(HasSubstr("asked for its settings and has no " + std::string(name) + " among them; set its dial"),
                      Not(HasSubstr("plug it in")), Not(HasSubstr("Bad parameters"))));
  }
}

TEST_P(CameraMakes, ACameraWithoutRawPicturesIsRefusedInOneSentence) {
  EXPECT_THAT(said_with({.jpeg_only = true}),
              AllOf(HasSubstr("to deliver raw pictures and offers only "), HasSubstr("take a camera that has raw")));
}

TEST_P(CameraMakes, ASettingThatIsAcceptedAndNotDoneIsSeen) {
  const auto camera = open();
  const rig::CameraSettings wanted{.exposure_s = 2, .iso = 400, .f_number = 4};
  const std::array<std::pair<rig::BodyCondition, std::string>, 3> locked{{{{.shutter_locked = true}, make.shutter},
                                                                          {{.iso_locked = true}, "iso"},
                                                                          {{.f_number_locked = true}, make.aperture}}};
  for (const auto& [condition, name] : locked) {
    wired.body->set_condition(condition);
    EXPECT_THAT(refusal([&] { camera->configure(wanted); }),
                AllOf(HasSubstr("set its " + name + " to "), HasSubstr("and stays at"), HasSubstr("dial to M")));
    wired.body->set_condition({});
    camera->configure({.exposure_s = 0.25, .iso = 100, .f_number = 8});
  }
  EXPECT_EQ(refusal([&] { camera->configure(wanted); }), "(accepted)");
}

TEST_P(CameraMakes, AStalePictureIsRefusedAndAFullCardIsSaid) {
  const auto camera = open();
  camera->capture();
  wired.body->set_condition({.repeats_last_picture = true});
  EXPECT_THAT(refusal([&] { camera->capture(); }), HasSubstr("delivered before"));
  wired.body->set_condition({.store_full = true});
  EXPECT_THAT(refusal([&] { camera->capture(); }), HasSubstr("card is full; empty the card, then resume"));
  wired.body->set_condition({});
  EXPECT_TRUE(delivers_what_was_made(*camera));
}

TEST_P(CameraMakes, APictureThatWaitsFromBeforeIsNotTakenForTheNextOne) {
  const auto camera = open();
  camera->configure({.exposure_s = 0.25, .iso = 100, .f_number = 8});
  wired.body->handle(make.somebody_presses_the_button);
  while (wired.body->waiting_pictures() == 0) std::this_thread::yield();
  const rig::Picture picture = camera->capture();
  ASSERT_EQ(wired.recorded.count(), 2u);
  EXPECT_EQ(picture.bytes, wired.recorded.last().bytes);
}

TEST_P(CameraMakes, ALiveViewCostsTheNextPictureNothing) {
  const auto camera = open();
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(camera->preview().empty());
    EXPECT_FALSE(camera->preview().empty());
    EXPECT_EQ(wired.body->shows_live_view(), GetParam() != CameraMake::sony);
    EXPECT_TRUE(delivers_what_was_made(*camera));
    EXPECT_FALSE(wired.body->shows_live_view()) << "its mirror is still up";
  }
}

TEST_P(CameraMakes, AFileThatBreaksOffIsTakenAgain) {
  const auto camera = open();
  for (const long bytes : {0L, 1L, 4096L}) {
    wired.server->cut_after(bytes);
    EXPECT_TRUE(delivers_what_was_made(*camera)) << bytes;
  }
}

TEST_P(CameraMakes, ACableThatIsPulledIsSaidAndTheNextPictureComesWhenItIsBack) {
  const auto camera = open();
  camera->capture();
  wired.server->unplug();
  EXPECT_THAT(refusal([&] { camera->capture(); }), HasSubstr("camera"));
  EXPECT_THAT(refusal([&] { camera->capture(); }), HasSubstr("cable"));
  wired.server->plug_in();
  EXPECT_TRUE(delivers_what_was_made(*camera));
}

TEST_P(CameraMakes, TheCommandFindsThemAndSetsTheExposureAndTheQuality) {
  const Gphoto2 gphoto2(wired);
  const std::string said = gphoto2.run("--summary");
  EXPECT_THAT(said, HasSubstr("Manufacturer: " + std::string(make.manufacturer)));
  EXPECT_THAT(said, HasSubstr("Model: " + std::string(make.model)));
  const std::string f = GetParam() == CameraMake::canon ? "5.6" : "f/5.6";
  for (const auto& [name, value] : std::vector<std::pair<std::string, std::string>>{{"iso", "400"},
                                                                                    {make.shutter, "1/125"},
                                                                                    {make.shutter, "2"},
                                                                                    {make.aperture, f},
                                                                                    {make.quality, make.raw_and_jpeg},
                                                                                    {make.quality, make.raw}}) {
    gphoto2.run("--set-config '" + name + "=" + value + "'");
    EXPECT_THAT(gphoto2.run("--get-config " + name), HasSubstr("Current: " + value + "\n"));
  }
}

TEST_P(CameraMakes, TheCommandDownloadsTheRawPictureWhoseMosaicTheBenchDrew) {
  const Gphoto2 gphoto2(wired);
  gphoto2.run("--set-config '" + std::string(make.quality) + "=" + make.raw + "' --capture-image-and-download");
  ASSERT_EQ(wired.recorded.count(), 1u);
  const auto bytes = gphoto2.bytes_of("capt0000." + std::string(make.extension));
  EXPECT_EQ(bytes, wired.recorded.last().bytes);
  EXPECT_EQ(read_raw(bytes).mosaic.size(), cv::Size(60, 40));
}

TEST_P(CameraMakes, TheCommandDownloadsRawAndJpegOfOneExposureAndShowsALiveView) {
  const Gphoto2 gphoto2(wired);
  gphoto2.run("--set-config '" + std::string(make.quality) + "=" + make.raw_and_jpeg +
              "' --capture-image-and-download");
  ASSERT_EQ(wired.recorded.count(), 1u);
  EXPECT_EQ(gphoto2.bytes_of("capt0000." + std::string(make.extension)), wired.recorded.last().bytes);
  EXPECT_EQ(gphoto2.files_ending_in(".jpg"), 1u);
  gphoto2.run("--capture-preview");
  const auto jpeg = gphoto2.bytes_of("capture_preview.jpg");
  ASSERT_GT(jpeg.size(), 100u);
  EXPECT_EQ(jpeg[0], std::byte{0xff});
}

TEST(NikonCamera, WhoseAutomaticIsoIsOnIsToldWhereToSwitchItOff) {
  WiredCamera wired({}, {}, CameraMake::nikon);
  wired.body->set_condition({.auto_iso = true});
  EXPECT_THAT(refusal([&] {
                rig::make_process_camera({.command = {"/proc/self/exe", "camera-process"},
                                          .camera = {.port = wired.port(), .width_px = 60, .height_px = 40}});
              }),
              AllOf(HasSubstr("isoauto is \"On\" and has to be \"Off\""), HasSubstr("Auto ISO > Off")));
}
