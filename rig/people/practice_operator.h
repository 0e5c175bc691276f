// A person who practises on a simulated bench: is asked as on a real one, and the simulated hand then does it.
#pragma once

#include <memory>

#include "rig/people/operator.h"

namespace rig {

// `arrange` asks `person` first, and changes nothing when that throws; then lets `hand` do it.
std::unique_ptr<Operator> make_practice_operator(std::unique_ptr<Operator> person, std::unique_ptr<Operator> hand);

}  // namespace rig
