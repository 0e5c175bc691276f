// The search for what is plugged into this computer: cameras and serial ports, and what each is believed to be. No
// device is opened, so one that another program uses is listed, too.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rig {

struct FoundDevice {
  std::string kind;                // "camera" or "serial port"
  std::string name;                // "Sony ILCE-7M2 (Control)", "/dev/ttyACM0 - Arduino Uno"
  std::string port;                // as a rig file names it: "usb:001,004", "/dev/ttyACM0"
  std::string usb_id;              // "2341:0043"; empty when it is unknown or the device is not on USB
  std::string serial;              // empty when it cannot be known without opening the device
  std::string believed_to_be;      // for people: "perhaps a GRBL turntable (Arduino)"
  std::string by_id{}, by_path{};  // links to a serial port that keep their names; empty where there is none
  std::string recommended{};       // the port as it is best written into a rig file
};

// The cameras and the serial ports; empty when nothing is attached. Errors: std::runtime_error when the system cannot
// be asked.
std::vector<FoundDevice> find_cameras();
std::vector<FoundDevice> find_serial_ports();

// Gives each port its links below `folder`/by-id (named for the adapter) and `folder`/by-path (named for the socket
// that it is plugged into), and recommends one name: the first link that leads to no other port, whatever is plugged
// in. An adapter without a serial number shares its by-id link with every other one of its kind.
void name_for_good(std::vector<FoundDevice>& ports, const std::filesystem::path& folder = "/dev/serial");

// Both, cameras first.
std::vector<FoundDevice> find_devices();

// In words, what is usually behind a serial port with this USB vendor (-1: not a USB device).
std::string believed_serial_device(int usb_vendor_id);

}  // namespace rig
