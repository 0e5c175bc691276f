// The second simulation of GRBL (documented_grbl.h) as the firmware at a simulated bench's port: whatever is tried on
// the first one, its faults of the line and whole programs among them, is tried on this one too.
#pragma once

#include <memory>

#include "rig/simulated/simulated_bench.h"
#include "rig/simulated/simulated_firmware.h"

// A board with the settings that a turntable needs, of 40 steps per degree and with the speed of the bench's truth,
// which it reaches in a fifth of a second. It homes in negative direction and ends that at the platform's true angle 0,
// or a whole number of turns from there; `with_switch` false: it has no home switch. As a real board it obeys a line
// when time has gone on; with `answers_at_once` it answers within the call, so that a fault of the line meets the
// answer to its own command. `bench` and `clock` must outlive it. It does not jam.
std::unique_ptr<rig::SimulatedFirmware> make_documented_firmware(rig::SimulatedBench& bench, rig::Clock& clock,
                                                                 bool with_switch, bool answers_at_once = false);
