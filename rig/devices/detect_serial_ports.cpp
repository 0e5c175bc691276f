#include <libserialport.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "rig/devices/detect.h"

namespace rig {
namespace {

std::string text_or_empty(const char* text) {
  return text == nullptr ? "" : text;
}

std::string usb_id_text(int vendor, int product) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%04x:%04x", static_cast<unsigned>(vendor), static_cast<unsigned>(product));
  return text.data();
}

FoundDevice described(const sp_port* port) {
  FoundDevice found{.kind = "serial port",
                    .name = text_or_empty(sp_get_port_description(port)),
                    .port = text_or_empty(sp_get_port_name(port)),
                    .usb_id = "",
                    .serial = "",
                    .believed_to_be = ""};
  int vendor = -1, product = -1;
  if (sp_get_port_usb_vid_pid(port, &vendor, &product) == SP_OK) {
    found.usb_id = usb_id_text(vendor, product);
    found.serial = text_or_empty(sp_get_port_usb_serial(port));
  } else {
    vendor = -1;
  }
  found.believed_to_be = believed_serial_device(vendor);
  return found;
}

// The links in a folder by the device that they lead to; of several the first by name.
std::map<std::string, std::string> links_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> links;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    std::error_code nowhere;
    const std::string device = std::filesystem::canonical(entry.path(), nowhere).string();
    if (nowhere) continue;
    std::string& link = links[device];
    if (link.empty() || entry.path().string() < link) link = entry.path().string();
  }
  return links;
}

// Two adapters with one serial number, as some makers sell them, compete for one link.
bool has_by_id_link_of_its_own(const FoundDevice& port, const std::vector<FoundDevice>& ports) {
  return !port.by_id.empty() && !port.serial.empty() && std::ranges::none_of(ports, [&](const FoundDevice& other) {
    return other.usb_id == port.usb_id && other.serial == port.serial && other.by_id.empty();
  });
}

}  // namespace

void name_for_good(std::vector<FoundDevice>& ports, const std::filesystem::path& folder) {
  const auto by_id = links_in(folder / "by-id"), by_path = links_in(folder / "by-path");
  const auto link = [](const std::map<std::string, std::string>& links, const FoundDevice& port) {
    const auto found = links.find(port.port);
    return found == links.end() ? std::string() : found->second;
  };
  for (FoundDevice& port : ports) {
    port.by_id = link(by_id, port);
    port.by_path = link(by_path, port);
  }
  for (FoundDevice& port : ports) {
    port.recommended = has_by_id_link_of_its_own(port, ports) ? port.by_id
                       : port.by_path.empty()                 ? port.port
                                                              : port.by_path;
  }
}

std::string believed_serial_device(int usb_vendor_id) {
  switch (usb_vendor_id) {
    case -1:
      return "a port of the computer itself";
    case 0x2341:
    case 0x2a03:
      return "perhaps a GRBL turntable (Arduino)";
    case 0x1a86:
      return "perhaps a GRBL turntable (Arduino clone, CH340)";
    case 0x10c4:
      return "perhaps a GRBL turntable (ESP32 board, CP210x)";
    case 0x303a:
      return "perhaps a FluidNC turntable (ESP32)";
    case 0x0483:
      return "perhaps a grblHAL turntable (STM32 board)";
    case 0x0403:
      return "perhaps a Zaber stage or another device behind an FTDI adapter";
    case 0x2939:
      return "perhaps a Zaber stage";
    default:
      return "a USB serial device";
  }
}

std::vector<FoundDevice> find_serial_ports() {
  sp_set_debug_handler(nullptr);
  sp_port** ports = nullptr;
  if (sp_list_ports(&ports) != SP_OK) {
    throw std::runtime_error(
        "the computer was asked for its serial ports and could not list them; check that /sys is mounted");
  }
  const std::unique_ptr<sp_port*, void (*)(sp_port**)> owner(ports, sp_free_port_list);
  std::vector<FoundDevice> found;
  for (sp_port** port = ports; *port != nullptr; ++port) found.push_back(described(*port));
  name_for_good(found);
  return found;
}

std::vector<FoundDevice> find_devices() {
  std::vector<FoundDevice> found = find_cameras();
  for (FoundDevice& port : find_serial_ports()) found.push_back(std::move(port));
  return found;
}

}  // namespace rig
