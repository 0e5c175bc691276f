// Where the place of a platform is kept, and when it is forgotten.
#include "station/bench/platform_memory.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "station/bench/home_platform.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station {
namespace {

namespace fs = std::filesystem;

TEST(PlatformMemory, IsOneWhateverNameOfItsPortTheRigFileHas) {
  const station_test::TemporaryFolder folder;
  const fs::path at = fs::canonical(folder.path());
  std::vector<rig::FoundDevice> found(2);
  for (int i : {0, 1}) {
    found[i].port = (at / ("ttyUSB" + std::to_string(i))).string();
    std::ofstream(found[i].port) << "";
  }
  found[1].usb_id = "2341:0043";
  found[1].serial = "7513";
  const fs::path by_id = at / "by-id/usb-Arduino_Uno_7513-if00", by_path = at / "by-path/pci-0000:00:14.0-usb-0:2:1.0";
  for (const fs::path& link : {by_id, by_path}) {
    fs::create_directory(link.parent_path());
    fs::create_symlink("../ttyUSB1", link);
  }
  rig::name_for_good(found, at);
  for (const rig::SerialPortChoice& choice : {rig::SerialPortChoice{.port = found[1].port, .usb_serial = ""},
                                              {.port = by_id, .usb_serial = ""},
                                              {.port = by_path, .usb_serial = ""},
                                              {.port = "", .usb_serial = "7513"}})
    EXPECT_EQ(lasting_name(choice, found), by_id.string()) << choice.port;
  EXPECT_EQ(lasting_name({.port = found[0].port, .usb_serial = ""}, found), found[0].port);
  EXPECT_EQ(lasting_name({.port = "/dev/ttyUSB7", .usb_serial = ""}, found), "/dev/ttyUSB7") << "not plugged in";
}

// Nobody knows then whether the person has turned it; without a memory the next program would believe so.
TEST(PlatformMemory, IsNotForgottenWhenTheTurntableIsNotThere) {
  const station_test::TemporaryFolder folder;
  ::setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
  nlohmann::json rig = read_json_file(std::string(DATA_DIR) + "/rigs/grbl_sony_network.json");
  rig["turntable_setup"].erase("baud");
  rig["turntable_setup"].update({{"line", "pty"}, {"port", "/dev/pts/nowhere"}});
  write_json_file(folder / "rig.json", rig);
  const fs::path memory = platform_memory_file(read_rig(folder / "rig.json"));
  remember_platform(memory, nullptr)->keep({.steps = 0, .angle_rad = 1});
  EXPECT_THROW(home_platform({.rig = folder / "rig.json", .stands_at_mark = true}), std::runtime_error);
  EXPECT_TRUE(fs::exists(memory));
}

}  // namespace
}  // namespace station
