// A platform without a motor: a person turns it by hand, reads its scale and says so.
#pragma once

#include <memory>

#include "rig/devices/turntable.h"
#include "rig/people/asked_person.h"

namespace rig {

// `asked` must outlive the turntable. A move asks the person to turn the platform; the answer says that it stands at
// the angle asked, or at how many degrees, or that it cannot be done. Angles within +-360 deg.
std::unique_ptr<Turntable> make_manual_turntable(AskedPerson& asked);

}  // namespace rig
