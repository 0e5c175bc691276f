// An operator who is a person: is told what is to be done, does it and says so.
#pragma once

#include <memory>

#include "rig/people/asked_person.h"
#include "rig/people/operator.h"

namespace rig {

// `asked` must outlive the operator. The first arrangement is said in full, because what stands on the bench is
// not known yet; later ones say the differences, and nothing is asked where there are none. `arrange` throws when the
// person declines, or when the input ends.
std::unique_ptr<Operator> make_console_operator(AskedPerson& asked);

}  // namespace rig
