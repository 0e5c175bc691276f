// A Sony ILCE-7M2 as its PTP operations see it: identity, properties, the two-stage release, pictures waiting in its
// memory. What it photographs comes from a camera of the simulated bench.
//
// Shutter, aperture and ISO are set by relative steps, as that generation does. The shutter steps through libgphoto2's
// own table, which is the order of the real dial.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig/camera.h"

namespace rig {

struct PtpRequest {
  std::uint16_t code = 0;
  std::vector<std::uint32_t> parameters;
  std::string data;  // what the host sent along
};

struct PtpAnswer {
  std::uint16_t code = 0x2001;  // OK
  std::optional<std::string> data;
};

// What can be wrong with a camera, for tests and the rig's faults.
struct SonyCondition {
  int exposure_program = 1;  // 1 = M; 2 P, 3 A, 4 S
  int focus_mode = 1;        // 1 = manual; 2 AF-S
  int battery_percent = 80;
  // Settings that it accepts and does not do.
  bool shutter_locked = false, iso_locked = false, f_number_locked = false, quality_locked = false;
  bool oversteps = false;  // goes one step further than it was asked
  bool store_full = false;
  bool repeats_last_picture = false;
};

class SimulatedSony {
 public:
  virtual ~SimulatedSony() = default;
  virtual PtpAnswer handle(const PtpRequest& request) = 0;
  virtual int waiting_pictures() = 0;  // each one is announced by an event of its own
  virtual void set_condition(const SonyCondition& condition) = 0;
};

// `camera` must outlive it; its preview is the live view and the JPEG beside a raw file. An exposure goes on in a thread of
// its own, so that questions are answered.
std::unique_ptr<SimulatedSony> make_simulated_sony(Camera& camera);

}  // namespace rig
