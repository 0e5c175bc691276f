// What the program and its camera process say to each other, over one socket: frames.
//
// A frame: the four characters "TSC1", the length of its JSON text and the length of its bytes (both 4 bytes, little
// endian), the JSON text (an object, UTF-8), the bytes (a picture; mostly none). The program asks, the process answers
// each question once, in order.
//
//   {"ask": "connect", "port", "width_px", "height_px", "shortest_shutter_s", "least_battery_percent"}
//                                              -> {"identity": {...}, "shutter_times_s": [...]}
//   {"ask": "configure", "settings": {...}}    -> {"settings": {...}}, read back
//   {"ask": "capture"}                         -> {"settings": {...}, "extension", "utc"} and the picture's bytes
//   {"ask": "preview"}                         -> {} and the bytes of a JPEG
//   any of them                                -> {"error": "one line for people", "lost": whether it may be asked again}
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "rig/camera.h"

namespace rig {

struct CameraFrame {
  nlohmann::json text = nlohmann::json::object();
  std::vector<std::byte> bytes;
};

// Puts frames together from pieces of any size. Errors: std::runtime_error when what comes is none.
class CameraFrames {
 public:
  void add(std::string_view piece);
  bool next(CameraFrame& frame);  // false: not yet whole

 private:
  std::string waiting_;
};

std::string encode_frame(const CameraFrame& frame);

nlohmann::json settings_to_json(const ExposureSettings& settings);
ExposureSettings settings_from_json(const nlohmann::json& document);

}  // namespace rig
