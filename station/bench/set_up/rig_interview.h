// What a person is asked about a new bench: what its devices are, what is written on them, and the few measures that
// only a tape can take.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "rig/people/asked_person.h"

namespace station {

// A rig file that is being made: its document, in the order in which keys are written.
using RigDraft = nlohmann::ordered_json;

// Which ready rig file is nearest to the bench: its name in station/data/rigs without its ending.
std::string ask_for_ready_rig(rig::AskedPerson& asked);

// Looks for the camera and the turntable that the draft names on USB and serial ports, asks where there are none or
// several, and writes their ports into it. Nothing is done for devices of a simulated bench.
void ask_for_ports(RigDraft& draft, rig::AskedPerson& asked);

// Asks for names and measures, each beside what the draft says already, which Enter keeps. A value that cannot be is
// asked again with the reason. `keep` is called after each answer.
void ask_for_measures(RigDraft& draft, rig::AskedPerson& asked, const std::function<void()>& keep);

}  // namespace station
