// Any bytes as what the camera process says: whole frames come out the same when they are written again, and everything
// else is refused.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "rig/cameras/camera_frames.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rig::CameraFrames frames;
  try {
    frames.add({reinterpret_cast<const char*>(data), size});
    for (rig::CameraFrame frame; frames.next(frame);) {
      rig::CameraFrames again;
      again.add(rig::encode_frame(frame));
      rig::CameraFrame same;
      if (!again.next(same) || same.text != frame.text || same.bytes != frame.bytes) std::abort();
    }
  } catch (const std::runtime_error&) {
  }
  return 0;
}
