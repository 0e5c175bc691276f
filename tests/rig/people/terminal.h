// A person at a terminal whose answers are known before.
#pragma once

#include <sstream>

#include "rig/people/asked_person.h"

namespace rig_test {

struct Terminal {
  explicit Terminal(const std::string& answers) : in(answers) {}
  std::istringstream in;
  std::ostringstream out;
  std::unique_ptr<rig::AskedPerson> person = rig::make_person_at_terminal(in, out);
};

}  // namespace rig_test
