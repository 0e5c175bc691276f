// A simulated controller with its plug, and the plan of what goes wrong on the line to it.
//
// A fault happens at an operation, which is a command that reaches the firmware: a line, or one of GRBL's real-time
// characters. The plan is plain data, so that a test can sweep over it and a file can hold it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rig/simulated/simulated_firmware.h"
#include "rig/turntables/byte_line.h"

namespace rig {

enum class LineFault {
  silence,      // from now on nothing is said and nothing done, until the power comes back
  lost_reply,   // the answer is missing
  garbage,      // noise before the answer
  wrong_digit,  // a digit of the position in the answer is another one
  glued,        // the answer's line end is missing: it runs into the next one
  split,        // the answer comes in halves
  late,         // the answer comes after the next question, in front of that one's answer
  repeated,     // the answer comes twice
  reset,        // the firmware starts anew by itself
  alarm,        // the platform runs into its end switch
  jam,          // the platform no longer follows the motor
  unplug,       // the line is gone
  wrong_device  // from now on everything is echoed
};

struct PlannedLineFault {
  int at_operation = 1;  // the first is 1
  LineFault fault = LineFault::silence;
};
using LineFaultPlan = std::vector<PlannedLineFault>;

// The end to which a line, in process or on a pseudo-terminal, is connected. It may be called from several threads.
class SimulatedPort {
 public:
  virtual ~SimulatedPort() = default;
  virtual void power_on() = 0;  // plugs the board in (again): the firmware starts, and faults that last are over
  virtual void opened() = 0;    // a program opens the port: a board that is plugged in starts anew; another stays dead
  virtual void receive(std::string_view bytes) = 0;
  virtual std::string transmit() = 0;
  virtual void unplug() = 0;
  virtual bool plugged() = 0;
  virtual int operations() = 0;  // operations so far; a run without faults tells a sweep how many there are
};

std::shared_ptr<SimulatedPort> make_simulated_port(std::unique_ptr<SimulatedFirmware> firmware,
                                                   LineFaultPlan plan = {});

// A line in memory, which lets the clock move on while nothing comes. Opening it starts the board anew, as the control
// lines of a real port do. Throws Unplugged when the port is unplugged.
std::unique_ptr<ByteLine> open_simulated_line(std::shared_ptr<SimulatedPort> port, Clock& clock);

}  // namespace rig
