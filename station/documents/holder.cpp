#include "station/documents/holder.h"

namespace station {

void read_holder(ObjectReader holder, inversion::WrappedSpool& wrapping) {
  wrapping.frame_width_mm = holder.number("frame_width_mm", 1, 1000);
  wrapping.frame_height_mm = holder.number("frame_height_mm", 1, 1000);
  wrapping.frame_depth_mm = holder.number("frame_depth_mm", 0.1, 500);
  wrapping.window_width_mm = holder.number("window_width_mm", 0.5, wrapping.frame_width_mm);
  wrapping.window_height_mm = holder.number("window_height_mm", 0.5, wrapping.frame_height_mm);
  holder.finish();
}

}  // namespace station
