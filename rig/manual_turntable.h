// A platform without a motor: a person turns it by hand, reads its scale and says so.
#pragma once

#include <iosfwd>
#include <memory>

#include "rig/turntable.h"

namespace rig {

// The streams must outlive the turntable. A move asks the person to turn the platform; Enter says that it stands at the
// angle asked, a number that it stands at that many degrees, q that it cannot be done. Angles within +-360 deg.
std::unique_ptr<Turntable> make_manual_turntable(std::istream& in, std::ostream& out);

}  // namespace rig
