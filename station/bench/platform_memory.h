// The place where a turntable without a home switch was left, in a file that the next program reads.
//
// A platform stays where it is whoever starts the next program, so the file belongs to the turntable and not to a
// folder of sessions: $XDG_STATE_HOME/threadstation (~/.local/state/threadstation), one file for each port, whatever
// link to it is used. Its key "turning" is true when the program was ended in the middle of a move, "lost" when nobody
// knows where the platform stands.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rig/devices/detect.h"
#include "rig/people/asked_person.h"
#include "rig/turntables/stepper_turntable.h"
#include "station/documents/rig_file.h"

namespace station {

// Whether a rig's turntable has no other way to know where it stands: one at a port of its own and without a home
// switch.
bool remembers_its_place(const RigFile& rig);

// The file for a rig's turntable. Throws std::runtime_error when the rig names no port or there is no home folder.
std::filesystem::path platform_memory_file(const RigFile& rig);

// The name under which a port is remembered: the one that `found` recommends for it, however the rig file names it.
std::string lasting_name(const rig::SerialPortChoice& port, const std::vector<rig::FoundDevice>& found);

// What `file` remembers. `asked`, who must outlive the memory, turns the platform to its mark when the place is not
// known; nobody does where it is null. Reading refuses a damaged file with std::runtime_error.
std::shared_ptr<rig::PlatformMemory> remember_platform(const std::filesystem::path& file, rig::AskedPerson* asked);

// Turns a platform whose place is remembered back to 0, so that the next program finds it where it expects it.
void leave_at_zero(const RigFile& rig, rig::Turntable& turntable);

// Forgets the place: the platform stands at its mark.
void forget_platform(const std::filesystem::path& file);

}  // namespace station
