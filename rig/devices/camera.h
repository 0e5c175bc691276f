// The interface of a tethered camera: its exposure is set and read back, and its pictures come as the files that it
// made.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rig {

struct CameraSettings {
  double exposure_s = 0.25;  // shutter time
  int iso = 100;
  double f_number = 8.0;  // read back; what was asked for when the lens has no electronic aperture
};

struct CameraIdentity {
  std::string make, model, serial;
  int width_px = 0, height_px = 0;
};

struct Picture {
  std::vector<std::byte> bytes;  // the file as the camera delivered it
  std::string extension;         // "arw", "cr2", "nef": one of those that is_raw_extension() knows
  CameraSettings settings;       // read back from the camera when it was taken
  std::string utc;               // when the exposure began
};

// Errors: std::runtime_error whose message says what was asked, what came back and what the person can do.
class Camera {
 public:
  virtual ~Camera() = default;
  virtual CameraIdentity identity() = 0;
  virtual std::vector<double> shutter_times_s() = 0;                   // the times that it offers, ascending
  virtual CameraSettings configure(const CameraSettings& wanted) = 0;  // returns the settings read back
  virtual Picture capture() = 0;
  virtual std::vector<std::byte> preview() = 0;  // a small JPEG of what the camera sees now, at any exposure
};

// True for the extension (small letters, without its point) of a camera's raw files.
bool is_raw_extension(std::string_view extension);

// The offered shutter time nearest to `wanted_s` in stops.
double nearest_shutter_s(const std::vector<double>& offered_s, double wanted_s);

}  // namespace rig
