#include "rig/devices/turntable.h"

#include <stdexcept>

namespace rig {

void Turntable::stands_at(double /*angle_rad*/) {
  throw std::runtime_error(
      "the platform was measured to stand elsewhere than it reads; it finds its home by itself: home it");
}

}  // namespace rig
