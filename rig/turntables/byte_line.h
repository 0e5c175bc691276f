// A line that carries bytes to and from a motor controller: a serial port, a pseudo-terminal, or memory alone.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace rig {

// The other end is gone (plug pulled, power off, port closed). Never thrown for a device that is only silent.
struct Unplugged : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Errors: Unplugged, and std::runtime_error when the line does not take what is written.
class ByteLine {
 public:
  virtual ~ByteLine() = default;
  virtual std::string read(double timeout_s) = 0;  // the bytes that came, as soon as any are there; empty: none in time
  virtual void write(std::string_view bytes) = 0;  // writes all bytes or throws, without waiting; any thread may call
};

}  // namespace rig
