// Any bytes as a raw picture: it is read, or refused with a message.
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>

#include "calibration/sensor/sensor_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    calibration::read_sensor_bytes(std::as_bytes(std::span(data, size)), "fuzzed picture");
  } catch (const std::runtime_error&) {
  }
  return 0;
}
