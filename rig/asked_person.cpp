#include "rig/asked_person.h"

#include <istream>
#include <ostream>
#include <stdexcept>

namespace rig {

std::string ask_person(std::istream& in, std::ostream& out, const std::string& todo, const std::string& how) {
  out << todo << "\n" << how << std::flush;
  std::string answer;
  if (!std::getline(in, answer)) {
    throw std::runtime_error("asked to: \"" + todo +
                             "\", but the input ended before anybody answered; run it at a terminal");
  }
  if (answer == "q" || answer == "Q") {
    throw std::runtime_error("asked to: \"" + todo + "\", and the person declined; resume when it can be done");
  }
  return answer;
}

}  // namespace rig
