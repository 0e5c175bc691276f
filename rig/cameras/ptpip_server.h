// Puts a simulated camera on this computer's network (127.0.0.1 only) by PTP/IP, as cameras with Wi-Fi do, so that
// libgphoto2 and every program on it find a camera there.
#pragma once

#include <memory>

#include "rig/cameras/camera_faults.h"
#include "rig/cameras/simulated_sony.h"

namespace rig {

class PtpipServer {
 public:
  virtual ~PtpipServer() = default;
  virtual int port() const = 0;            // of commands and of events: "ptpip:127.0.0.1:PORT:PORT"
  virtual void unplug() = 0;               // the connection breaks and nobody listens any more
  virtual void plug_in() = 0;              // at the same port
  virtual void cut_after(long bytes) = 0;  // of the next picture: then the connection breaks
  virtual int operations() = 0;            // so far; a sweep's range comes from a run without faults
};

// Serves one host at a time from a thread of its own until it is destroyed, and turns others away. `port` 0: one that is
// free. Throws std::runtime_error when the port cannot be had.
std::unique_ptr<PtpipServer> serve_on_ptpip(SimulatedSony& camera, int port = 0, CameraFaultPlan plan = {});

}  // namespace rig
