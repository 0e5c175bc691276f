// A simulated Sony ILCE-7M2 that answers PTP operations: identity, properties, the two-stage release, pictures waiting
// in its memory. Its pictures come from a camera of the simulated bench.
//
// Shutter, aperture and ISO are set by relative steps, as in cameras of that generation. The shutter steps through
// libgphoto2's own table, which has the order of the real dial.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig/devices/camera.h"

namespace rig {

struct PtpRequest {
  std::uint16_t code = 0;
  std::vector<std::uint32_t> parameters;
  std::string data;  // sent along by the host
};

struct PtpAnswer {
  std::uint16_t code = 0x2001;  // OK
  std::optional<std::string> data;
};

// The state of the camera, with what can be wrong with it, for tests and the rig's faults.
struct SonyCondition {
  int exposure_program = 1;  // 1 M, 2 P, 3 A, 4 S
  int focus_mode = 1;        // 1 manual, 2 AF-S
  int battery_percent = 80;
  // A locked setting is accepted and not done.
  bool shutter_locked = false, iso_locked = false, f_number_locked = false, quality_locked = false;
  bool oversteps = false;  // settings go one step further than asked
  bool store_full = false;
  bool repeats_last_picture = false;
};

class SimulatedSony {
 public:
  virtual ~SimulatedSony() = default;
  virtual PtpAnswer handle(const PtpRequest& request) = 0;
  virtual int waiting_pictures() = 0;  // number of pictures in its memory; each is announced by its own event
  virtual void set_condition(const SonyCondition& condition) = 0;
};

// `camera` must outlive the result; its preview serves as live view and as the JPEG beside a raw file. An exposure runs
// in a thread of its own, so that the camera answers questions meanwhile.
std::unique_ptr<SimulatedSony> make_simulated_sony(Camera& camera);

}  // namespace rig
