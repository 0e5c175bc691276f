// An operator at a terminal: reads what is to be done, does it and presses Enter.
#pragma once

#include <iosfwd>
#include <memory>

#include "rig/operator.h"

namespace rig {

// The streams must outlive the operator. The first arrangement is said in full, because what stands on the bench is
// not known yet; later ones say the differences, and nothing is asked where there are none. `arrange` throws when the
// person answers q, or when the input ends.
std::unique_ptr<Operator> make_console_operator(std::istream& in, std::ostream& out);

}  // namespace rig
