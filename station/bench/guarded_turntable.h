// A turntable that every ctrl-C stops, whatever command drives it.
#pragma once

#include <memory>
#include <stdexcept>

#include "rig/devices/turntable.h"

namespace station {

// A move that was not begun or not finished, because somebody asked to stop.
struct Interrupted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The same turntable. While it lives, ctrl-C (interrupt.h) stops it at once, from a thread of its own, and no move
// begins any more: home() and move_to() throw Interrupted. The process is not ended by the second ctrl-C but by the
// third, so that the stop is written before.
std::unique_ptr<rig::Turntable> guard_turntable(std::unique_ptr<rig::Turntable> turntable);

}  // namespace station
