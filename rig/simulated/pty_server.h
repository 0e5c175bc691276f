// A server that puts a simulated controller on a pseudo-terminal of this computer, so that any program can open it like
// a serial port.
#pragma once

#include <memory>
#include <string>

#include "rig/simulated/simulated_port.h"

namespace rig {

class PtyServer {
 public:
  virtual ~PtyServer() = default;
  virtual std::string path() const = 0;  // the pseudo-terminal's device file, as a rig file names it
};

// A server that works in a thread of its own until it is destroyed. A program that opens the terminal starts the
// controller anew; when the port is unplugged the terminal hangs up for good. Throws std::runtime_error when the system
// gives no pseudo-terminal.
std::unique_ptr<PtyServer> serve_on_pty(std::shared_ptr<SimulatedPort> port);

}  // namespace rig
