// An operator at a terminal sees a drawing of what is wanted before the sentences that say it.
#pragma once

#include <iosfwd>
#include <memory>
#include <string>

#include "rig/operator.h"

namespace station {

// Seven lines of at most 60 characters: the bench from above with lamp and room light, and the threads on the holder.
std::string drawing(const rig::Arrangement& wanted);

// The same for a program that draws it itself, one line: {"arrangement": {"object": "nothing", "board", "spectralon", "holder",
// "colour_chart" or "cylinder", "mounting": "horizontal" or "vertical", "on_platform", "lamp": "off", "front", "back" or
// "front_left", "room_light"}}.
std::string drawing_for_machines(const rig::Arrangement& wanted);

// Draws on `out` what it then asks of `person`; both must outlive the result.
std::unique_ptr<rig::Operator> make_drawing_operator(rig::Operator& person, std::ostream& out, bool for_machines);

}  // namespace station
