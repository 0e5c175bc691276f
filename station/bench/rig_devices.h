// The devices that a rig file names, connected and ready, with their clock.
#pragma once

#include <memory>
#include <optional>

#include "rig/devices/camera.h"
#include "rig/devices/clock.h"
#include "rig/devices/turntable.h"
#include "rig/people/asked_person.h"
#include "rig/people/operator.h"
#include "rig/simulated/ptpip_server.h"
#include "rig/simulated/pty_server.h"
#include "rig/simulated/simulated_bench.h"
#include "rig/turntables/byte_line.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"

namespace station {

// The command by which the program starts itself again as its camera process (rig/cameras/camera_process.h).
inline constexpr const char* kCameraProcess = "camera-process";

struct RigDevices {
  std::unique_ptr<rig::Clock> clock;
  std::unique_ptr<rig::SimulatedBench> bench;      // absent on a real rig
  std::unique_ptr<rig::PtyServer> simulated_wire;  // the turntable's firmware, when it is simulated on a wire
  struct {
    std::unique_ptr<rig::Camera> lens;  // what the simulated body photographs with
    std::unique_ptr<rig::SimulatedBody> body;
    std::unique_ptr<rig::PtpipServer> network;
  } simulated_camera;  // when it is simulated on a wire
  std::unique_ptr<rig::Camera> camera;
  std::unique_ptr<rig::Turntable> turntable;
  std::unique_ptr<rig::Operator> person;
};

// Connects all devices. The clock is the machine's as soon as a device is real, and a simulated one otherwise. `spool`
// is what is wrapped on the holder; a simulated bench needs it to draw the holder. `asked` is asked where the rig needs
// a person, and must outlive the devices; without one such a rig is refused. On a simulated bench the simulated hand
// then does what the person was asked. Ctrl-C stops the turntable, whoever drives it (guarded_turntable.h). Errors:
// BenchFault where camera or turntable fail, now or whenever they are asked later; std::runtime_error for a simulated
// camera with a real turntable or the reverse.
RigDevices open_rig(const RigFile& rig, const std::optional<Spool>& spool, rig::AskedPerson* asked);

// One device alone, with its clock; what is simulated stands on a bench that nobody draws.
RigDevices open_turntable(const RigFile& rig, rig::AskedPerson* asked);
RigDevices open_camera(const RigFile& rig);

// How many turntables that move were opened in this process; the simulated one without a wire moves nothing.
int turntables_opened();

// The line to a turntable's motor controller, to which nobody has spoken yet. Throws when it has none.
struct TurntableLine {
  RigDevices devices;  // the clock; what simulates the firmware
  std::shared_ptr<rig::ByteLine> line;
};
TurntableLine open_turntable_line(const RigFile& rig);

// How many steps the motor controller of a rig takes for a degree, as it says itself. Throws when it has none.
double controller_steps_per_deg(const RigFile& rig);

// Puts the simulated camera that a rig file names on this computer's network, photographing `devices.bench`.
void start_simulated_camera(const RigFile& rig, RigDevices& devices, const rig::CameraFaultPlan& faults = {});

// The simulated firmware that a rig file names, turning `bench`. Throws when it names none.
std::shared_ptr<rig::SimulatedPort> start_firmware(const RigFile& rig, rig::SimulatedBench& bench, rig::Clock& clock,
                                                   const rig::LineFaultPlan& faults = {});

}  // namespace station
