// The messages ("frames") that the program and its camera process exchange over one socket.
//
// A frame is the four characters "TSC1", the length of its JSON text and the length of its bytes (both 4 bytes, little
// endian), the JSON text (an object, UTF-8), then the bytes (a picture; mostly none). The program asks; the process
// answers each question once, in order.
//
//   {"ask": "connect", "port", "width_px", "height_px", "shortest_shutter_s", "least_battery_percent"}
//                                              -> {"identity": {...}, "shutter_times_s": [...]}
//   {"ask": "configure", "settings": {...}}    -> {"settings": {...}}, read back
//   {"ask": "capture"}                         -> {"settings": {...}, "extension", "utc"} and the picture's bytes
//   {"ask": "preview"}                         -> {} and the bytes of a JPEG
//   any question                               -> {"error": "one line for people", "lost": true or false}; "lost" says
//                                                 that the connection broke (CameraLost), so that asking again may help
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "rig/devices/camera.h"

namespace rig {

struct CameraFrame {
  nlohmann::json text = nlohmann::json::object();
  std::vector<std::byte> bytes;
};

// Puts frames together from pieces of any size. Errors: std::runtime_error when the bytes are not a frame.
class CameraFrames {
 public:
  void add(std::string_view piece);
  bool next(CameraFrame& frame);  // takes the next whole frame; false when none is complete yet

 private:
  std::string waiting_;
};

std::string encode_frame(const CameraFrame& frame);

nlohmann::json settings_to_json(const CameraSettings& settings);
CameraSettings settings_from_json(const nlohmann::json& document);

}  // namespace rig
