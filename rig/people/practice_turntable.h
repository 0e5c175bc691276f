// A platform that a person practises to turn on a simulated bench: the person is asked as on a real one, and the
// simulated platform then turns to where the person says that it stands.
#pragma once

#include <memory>

#include "rig/devices/turntable.h"

namespace rig {

// `by_hand` is asked first, and `simulated` does not move when that throws. State and angle are those of `by_hand`.
std::unique_ptr<Turntable> make_practice_turntable(std::unique_ptr<Turntable> by_hand,
                                                   std::unique_ptr<Turntable> simulated);

}  // namespace rig
