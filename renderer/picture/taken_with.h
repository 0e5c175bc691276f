// What a picture's file says of the camera that took it (EXIF, or a raw file's own words).
#pragma once

#include <filesystem>
#include <string>

namespace renderer {

// Empty and 0 where the file says nothing.
struct TakenWith {
  std::string camera, lens;  // make, model and serial number of the body; model of the lens
  double focal_length_mm = 0;
};

// Of a file that cannot be read: nothing.
TakenWith taken_with(const std::filesystem::path& file);

}  // namespace renderer
