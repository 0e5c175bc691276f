// What goes wrong on a line to simulated firmware, and at which operation: data, so that a test sweeps over it and a
// file can hold it. An operation is a command that reaches the firmware: a line, or one of GRBL's real-time characters.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rig/turntables/byte_line.h"
#include "rig/turntables/simulated_firmware.h"

namespace rig {

enum class LineFault {
  silence,      // from here on nothing is said and nothing done, until the power comes back
  lost_reply,   // one answer is missing
  garbage,      // noise before the answer
  glued,        // the answer's line end is missing: it runs into the next one
  split,        // the answer comes in halves
  late,         // the answer comes after the next question, before its answer
  repeated,     // the answer comes twice
  reset,        // the firmware starts anew by itself
  alarm,        // it runs into its end switch
  jam,          // the platform no longer follows the motor
  unplug,       // the line is gone
  wrong_device  // from here on everything is echoed
};

struct PlannedLineFault {
  int at_operation = 1;  // the first is 1
  LineFault fault = LineFault::silence;
};
using LineFaultPlan = std::vector<PlannedLineFault>;

// A simulated controller with its plug: what a line, in process or on a pseudo-terminal, is connected to. Calls may
// come from several threads.
class SimulatedPort {
 public:
  virtual ~SimulatedPort() = default;
  virtual void power_on() = 0;  // plugged in (again): the firmware starts, faults that last are over
  virtual void opened() = 0;    // by a program: the same for a board that is plugged in; another one stays dead
  virtual void receive(std::string_view bytes) = 0;
  virtual std::string transmit() = 0;
  virtual void unplug() = 0;
  virtual bool plugged() = 0;
  virtual int operations() = 0;  // so far; a sweep's range comes from a run without faults
};

std::shared_ptr<SimulatedPort> make_simulated_port(std::unique_ptr<SimulatedFirmware> firmware,
                                                   LineFaultPlan plan = {});

// A line without a wire: the clock moves on while nothing comes. Opening it starts the board anew, as the control lines
// of a real port do. Throws when it is unplugged.
std::unique_ptr<ByteLine> open_simulated_line(std::shared_ptr<SimulatedPort> port, Clock& clock);

}  // namespace rig
