// The writer of the simulated camera's files: uncompressed TIFF-based raw files, 14 bits in 16, which raw readers take
// for those of an ILCE-7M2, or DNG files with the name of a Canon or Nikon camera, whose own formats hold compressed
// pixels. A reader returns the mosaic and the levels exactly as they were given here.
//
// Layout: little endian; directory 0 names the camera and points to a sub-directory with the colour filter array and
// its levels (Sony's own: 0x7310 black, 0x7313 white balance, 0x787f white; or DNG's) and to an EXIF directory with the
// exposure. A genuine camera writes compressed rows, masked margins and a maker note as well; none of these is
// imitated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "rig/devices/camera.h"
#include "rig/simulated/camera_make.h"

namespace rig {

// The white level: the largest value of 14 bits. A genuine file repeats its white level in an encrypted directory (tag
// 0x787f). This writer leaves that out, and readers then take this value for the model, so no other can be written.
inline constexpr std::uint16_t kRawWhiteLevelDn = 16383;

struct RawFrame {
  cv::Mat1w mosaic;  // rows x columns, DN; RGGB: (0, 0) red, (0, 1) and (1, 0) green, (1, 1) blue
  std::uint16_t black_level_dn = 512;
  CameraSettings settings;  // f-number 0: the lens does not tell it
  CameraMake make = CameraMake::sony;
  std::string utc;             // as Clock::utc() gives it; EXIF dates have no zone, the file says UTC
  std::string serial;          // the body's serial number
  double focal_length_mm = 0;  // focal length of the lens on a 35 mm format sensor; 0: the file does not say it
};

// The bytes of the file. Throws std::runtime_error when there are no pixels, `utc` is not ISO 8601, a value needs more
// than 14 bits, or the settings are not positive numbers.
std::vector<std::byte> encode_raw(const RawFrame& frame);

}  // namespace rig
