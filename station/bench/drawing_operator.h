// A person who is asked to arrange the bench sees a drawing of what is wanted with the sentences that say it.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "rig/people/asked_person.h"
#include "rig/people/operator.h"

namespace station {

// Seven lines of at most 60 characters: the bench from above with lamp and room light, and the threads on the holder.
std::string drawing(const rig::Arrangement& wanted);

// The same for a program that draws it itself: {"object": "nothing", "board", "spectralon", "holder", "colour_chart" or
// "cylinder", "mounting": "horizontal" or "vertical", "on_platform", "stand" (its number, 0: none), "on_its_side",
// "kept_moving", "lamp": "off", "front", "back" or "front_left",
// "room_light"}.
nlohmann::json arrangement_document(const rig::Arrangement& wanted);

// Prepares `asked` with drawing and document ("arrangement") before `person` arranges; both must outlive the result.
std::unique_ptr<rig::Operator> make_drawing_operator(rig::Operator& person, rig::AskedPerson& asked);

}  // namespace station
