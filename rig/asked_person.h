// The person at a terminal who is asked to do something and answers with a line.
#pragma once

#include <iosfwd>
#include <string>

namespace rig {

// Says `todo` and how to answer it (`how`, "press Enter when it is done"), and returns the line that was typed. Errors:
// std::runtime_error when the person ends with q, or when the input ends.
std::string ask_person(std::istream& in, std::ostream& out, const std::string& todo, const std::string& how);

}  // namespace rig
