// A simulated camera body that answers PTP operations as its make does: identity, settings, release, pictures waiting
// in its memory, live view. Its pictures come from a camera of the simulated bench.
//
// Sony (ILCE-7M2): shutter, aperture and ISO are set by relative steps, as in cameras of that generation; the shutter
// steps through libgphoto2's own table, which has the order of the real dial. Canon (EOS 6D): settings and pictures are
// told in answers to "what is new" (EOS events), and a picture stays until its transfer is confirmed. Nikon (D750):
// settings are plain PTP properties, and the camera says that it is busy while the shutter is open.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rig/devices/camera.h"
#include "rig/simulated/camera_make.h"

namespace rig {

struct PtpRequest {
  std::uint16_t code = 0;
  std::vector<std::uint32_t> parameters;
  std::string data;  // sent along by the host
};

struct PtpAnswer {
  std::uint16_t code = 0x2001;  // OK
  std::optional<std::string> data;
  bool is_picture = false;  // the data are of a picture that was taken
};

// The state of the camera, with what can be wrong with it, for tests and the rig's faults.
struct BodyCondition {
  int exposure_program = 1;  // 1 M, 2 P, 3 A, 4 S
  int focus_mode = 1;        // 1 manual, 2 autofocus
  int battery_percent = 80;
  // A locked setting is accepted and not done.
  bool shutter_locked = false, iso_locked = false, f_number_locked = false, quality_locked = false;
  bool oversteps = false;  // settings go one step further than asked
  bool store_full = false;
  bool repeats_last_picture = false;
  bool no_aperture_choices = false;   // it has the property of the aperture, which reads 0 and cannot be set
  bool jpeg_only = false;             // it has no raw pictures
  bool auto_iso = false;              // Nikon: the ISO that is set is only where automatic ISO begins
  std::set<std::uint16_t> missing{};  // properties that it does not have
};

class SimulatedBody {
 public:
  virtual ~SimulatedBody() = default;
  virtual std::string name() const = 0;  // as it calls itself on the network
  virtual PtpAnswer handle(const PtpRequest& request) = 0;
  virtual int waiting_pictures() = 0;  // number of pictures in its memory
  // The code and parameter of the event that is sent for each of them; none where the host asks for them.
  virtual std::optional<std::pair<std::uint16_t, std::uint32_t>> picture_event() const = 0;
  virtual void set_condition(const BodyCondition& condition) = 0;
  // True as long as a host keeps the mirror up and the sensor warm; always false for a camera without a mirror, which
  // has one picture of its live view at a time.
  virtual bool shows_live_view() { return false; }
};

// `camera` must outlive the result; its preview serves as live view and as the JPEG beside a raw file. An exposure runs
// in a thread of its own, so that the camera answers questions meanwhile.
std::unique_ptr<SimulatedBody> make_simulated_body(Camera& camera, CameraMake make = CameraMake::sony);

// The PTP property of the aperture, which a camera does not have with a lens that has no electronic one.
std::uint16_t aperture_property(CameraMake make);

// The body of one make (simulated_sony.cpp, simulated_canon.cpp, simulated_nikon.cpp).
std::unique_ptr<SimulatedBody> make_simulated_sony(Camera& camera);
std::unique_ptr<SimulatedBody> make_simulated_canon(Camera& camera);
std::unique_ptr<SimulatedBody> make_simulated_nikon(Camera& camera);

}  // namespace rig
