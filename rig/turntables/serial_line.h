// The two kinds of line to a device file: a serial port, opened through libserialport, and a pseudo-terminal with
// another program behind it (simulated firmware, say), which that library refuses. Both are opened for this program
// alone.
#pragma once

#include <memory>
#include <string>

#include "rig/turntables/byte_line.h"

namespace rig {

// The choice of a port by its device file, or by what stays the same when that file's name changes: a link to it, as
// the system keeps them below /dev/serial, or the serial number of its USB adapter.
struct SerialPortChoice {
  std::string port;        // "/dev/ttyUSB0", "/dev/serial/by-path/..."; empty when the serial number chooses
  std::string usb_serial;  // empty when the port's name chooses
  int baud = 115200;
};

// Open lines; the serial one with 8 data bits, no parity, 1 stop bit and no flow control. Errors: std::runtime_error
// when there is no such port, it is in use, or it may not be opened.
std::unique_ptr<ByteLine> open_serial_line(const SerialPortChoice& choice);
std::unique_ptr<ByteLine> open_pty_line(const std::string& path);

}  // namespace rig
