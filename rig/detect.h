// What is plugged into this computer: cameras and serial ports, and what each is believed to be. Nothing is opened,
// so a device in use by another program is listed too.
#pragma once

#include <string>
#include <vector>

namespace rig {

struct FoundDevice {
  std::string kind;            // "camera" or "serial port"
  std::string name;            // "Sony ILCE-7M2 (Control)", "/dev/ttyACM0 - Arduino Uno"
  std::string port;            // what a rig file names: "usb:001,004", "/dev/ttyACM0"
  std::string usb_id;          // "2341:0043", empty when it is not a USB device or not known
  std::string serial;          // empty when it cannot be known without opening the device
  std::string believed_to_be;  // for people: "perhaps a GRBL turntable (Arduino)"
};

// Empty when nothing is attached. Throw std::runtime_error when the system cannot be asked.
std::vector<FoundDevice> find_cameras();
std::vector<FoundDevice> find_serial_ports();

// Cameras first.
std::vector<FoundDevice> find_devices();

// What is usually behind a serial port with this USB vendor; -1: not a USB device.
std::string believed_serial_device(int usb_vendor_id);

}  // namespace rig
