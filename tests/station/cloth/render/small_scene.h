// Scenes that are drawn in a moment.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "station/documents/reader.h"
#include "tests/places.h"

namespace station_test {

// A ready scene in few pixels, with its files named absolutely.
inline nlohmann::json small_scene(const std::string& name) {
  nlohmann::json scene = station::read_json_file(std::string(DATA_DIR) + "/scenes/" + name + ".json");
  for (nlohmann::json& thread : scene["threads"])
    thread = std::string(DATA_DIR) + "/scenes/" + thread.get<std::string>();
  for (nlohmann::json& cloth : scene["cloths"])
    cloth["draft"] = std::string(DATA_DIR) + "/scenes/" + cloth["draft"].get<std::string>();
  const int divisor = 12;
  scene["camera"]["width_px"] = scene["camera"]["width_px"].get<int>() / divisor;
  scene["camera"]["height_px"] = scene["camera"]["height_px"].get<int>() / divisor;
  scene["camera"]["focal_length_px"] = scene["camera"]["focal_length_px"].get<double>() / divisor;
  scene["samples_per_pixel"] = 2;
  return scene;
}

}  // namespace station_test
