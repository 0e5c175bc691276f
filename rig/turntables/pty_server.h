// Puts a simulated controller on a pseudo-terminal of this computer, so that any program can open it like a serial port.
#pragma once

#include <memory>
#include <string>

#include "rig/turntables/simulated_port.h"

namespace rig {

class PtyServer {
 public:
  virtual ~PtyServer() = default;
  virtual std::string path() const = 0;  // what a rig file names
};

// Serves from a thread of its own until it is destroyed. Whoever opens the terminal starts the controller anew; when the
// port is unplugged the terminal hangs up for good. Throws std::runtime_error when there is no pseudo-terminal.
std::unique_ptr<PtyServer> serve_on_pty(std::shared_ptr<SimulatedPort> port);

}  // namespace rig
