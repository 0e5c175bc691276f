#include "rig/devices/detect.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

namespace {

// A made-up /dev with ports and the links to them, removed with the test.
class MadeUpPorts {
 public:
  MadeUpPorts() {
    std::string name = std::filesystem::temp_directory_path() / "detectXXXXXX";
    root_ = std::filesystem::canonical(mkdtemp(name.data()));
    for (const char* kind : {"by-id", "by-path"}) std::filesystem::create_directories(folder() / kind);
  }
  ~MadeUpPorts() { std::filesystem::remove_all(root_); }
  MadeUpPorts(const MadeUpPorts&) = delete;
  MadeUpPorts& operator=(const MadeUpPorts&) = delete;

  void add(const std::string& port, const std::string& usb_id, const std::string& serial) {
    std::ofstream(root_ / port).close();
    rig::FoundDevice found;
    found.port = root_ / port;
    found.usb_id = usb_id;
    found.serial = serial;
    ports.push_back(found);
  }
  void link(const std::string& name, const std::string& port) const {
    std::filesystem::create_symlink("../../" + port, folder() / name);  // relative, as the system makes them
  }
  std::string link_path(const std::string& name) const { return folder() / name; }
  void name() { rig::name_for_good(ports, folder()); }

  std::vector<rig::FoundDevice> ports;

 private:
  std::filesystem::path folder() const { return root_ / "serial"; }
  std::filesystem::path root_;
};

}  // namespace

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

TEST(Detect, RecommendsTheLinkThatIsNamedForTheAdapterWhenThereIsOneSuchAdapter) {
  MadeUpPorts made;
  made.add("ttyACM0", "2341:0043", "7513");
  made.link("by-id/usb-Arduino_Uno_7513-if00", "ttyACM0");
  made.link("by-path/pci-0000:00:14.0-usb-0:1:1.0", "ttyACM0");
  made.link("by-id/usb-gone", "ttyUSB9");  // leads nowhere
  made.name();
  EXPECT_EQ(made.ports[0].by_id, made.link_path("by-id/usb-Arduino_Uno_7513-if00"));
  EXPECT_EQ(made.ports[0].by_path, made.link_path("by-path/pci-0000:00:14.0-usb-0:1:1.0"));
  EXPECT_EQ(made.ports[0].recommended, made.ports[0].by_id);
}

TEST(Detect, RecommendsTheLinkThatIsNamedForTheSocketWhenAdaptersAreAlike) {
  MadeUpPorts made;
  made.add("ttyUSB0", "1a86:7523", "");  // no serial number: the only link of two alike leads to either
  made.add("ttyUSB1", "1a86:7523", "");
  made.link("by-id/usb-1a86_USB_Serial-if00-port0", "ttyUSB1");
  made.link("by-path/pci-0000:00:14.0-usb-0:1:1.0-port0", "ttyUSB0");
  made.link("by-path/pci-0000:00:14.0-usb-0:2:1.0-port0", "ttyUSB1");
  made.link("by-path/pci-0000:00:14.0-usbv2-0:2:1.0-port0", "ttyUSB1");
  made.add("ttyUSB2", "10c4:ea60", "0001");  // one serial number for every piece
  made.add("ttyUSB3", "10c4:ea60", "0001");
  made.link("by-id/usb-Silicon_Labs_CP2102_0001-if00-port0", "ttyUSB3");
  made.link("by-path/pci-0000:00:14.0-usb-0:4:1.0-port0", "ttyUSB3");
  made.name();
  EXPECT_EQ(made.ports[0].recommended, made.link_path("by-path/pci-0000:00:14.0-usb-0:1:1.0-port0"));
  EXPECT_EQ(made.ports[1].recommended, made.link_path("by-path/pci-0000:00:14.0-usb-0:2:1.0-port0"));
  EXPECT_EQ(made.ports[2].recommended, made.ports[2].port);  // it has no link at all
  EXPECT_EQ(made.ports[3].recommended, made.link_path("by-path/pci-0000:00:14.0-usb-0:4:1.0-port0"));
}

TEST(Detect, RecommendsThePortItselfWhereTheSystemKeepsNoLinks) {
  MadeUpPorts made;
  made.add("ttyS0", "", "");
  rig::name_for_good(made.ports, "/nowhere/serial");
  EXPECT_EQ(made.ports[0].by_id + made.ports[0].by_path, "");
  EXPECT_EQ(made.ports[0].recommended, made.ports[0].port);
}
