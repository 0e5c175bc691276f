// A server that puts a simulated camera on this computer's network (127.0.0.1 only) by PTP/IP, as cameras with Wi-Fi
// do, so that libgphoto2 and every program that uses it find a camera there.
#pragma once

#include <memory>

#include "rig/simulated/camera_faults.h"
#include "rig/simulated/simulated_body.h"

namespace rig {

class PtpipServer {
 public:
  virtual ~PtpipServer() = default;
  virtual int port() const = 0;            // one port for commands and events: "ptpip:127.0.0.1:PORT:PORT"
  virtual void unplug() = 0;               // breaks the connection and stops listening
  virtual void plug_in() = 0;              // listens again at the same port
  virtual void cut_after(long bytes) = 0;  // breaks the connection after so many bytes of the next picture
  virtual int operations() = 0;            // operations so far; a run without faults tells a sweep how many there are
};

// A server that serves one host at a time from a thread of its own until it is destroyed, and turns others away; a
// connection that says nothing keeps nobody waiting. `port` 0 takes a free one. Throws std::runtime_error when the port
// cannot be had.
std::unique_ptr<PtpipServer> serve_on_ptpip(SimulatedBody& camera, int port = 0, CameraFaultPlan plan = {});

}  // namespace rig
