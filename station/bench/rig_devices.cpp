#include "station/bench/rig_devices.h"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "rig/cameras/camera_process.h"
#include "rig/people/console_operator.h"
#include "rig/people/manual_turntable.h"
#include "rig/people/practice_operator.h"
#include "rig/people/practice_turntable.h"
#include "rig/turntables/serial_line.h"
#include "station/bench/bench_fault.h"
#include "station/bench/bench_picture.h"
#include "station/bench/guarded_turntable.h"
#include "station/bench/platform_memory.h"

namespace station {
namespace {

bool turns_the_bench(const RigFile& rig) {
  return rig.turntable_driver == "simulated" ||
         (rig.turntable_wire && rig.turntable_wire->line == TurntableWire::Line::simulated);
}

bool photographs_the_bench(const RigFile& rig) {
  return rig.camera_driver == "simulated" || (rig.camera_wire && rig.camera_wire->simulated);
}

// Exposures and moves of a simulated rig take no real time, or `pace` of it; its clock starts at the real date.
std::unique_ptr<rig::Clock> make_clock(bool simulated, double pace = 0) {
  if (!simulated) return std::make_unique<rig::SystemClock>();
  const double now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  return std::make_unique<rig::SimulatedClock>(now, pace);
}

std::unique_ptr<rig::ByteLine> open_line(const TurntableWire& wire, const rig::PtyServer* server) {
  switch (wire.line) {
    case TurntableWire::Line::serial:
      return rig::open_serial_line(wire.port);
    case TurntableWire::Line::pty:
      return rig::open_pty_line(wire.port.port);
    case TurntableWire::Line::simulated:
      break;
  }
  return rig::open_pty_line(server->path());
}

void start_simulated_wire(const RigFile& rig, RigDevices& devices) {
  if (rig.turntable_wire->line == TurntableWire::Line::simulated)
    devices.simulated_wire = rig::serve_on_pty(start_firmware(rig, *devices.bench, *devices.clock));
}

std::unique_ptr<rig::Turntable> make_wired_turntable(const RigFile& rig, RigDevices& devices, rig::AskedPerson* asked) {
  TurntableWire wire = *rig.turntable_wire;
  if (remembers_its_place(rig)) wire.stepper.memory = remember_platform(platform_memory_file(rig), asked);
  start_simulated_wire(rig, devices);
  const auto connect = rig.turntable_driver == "grbl" ? rig::connect_grbl : rig::connect_zaber;
  // The addresses stay when the struct that owns them is moved.
  return rig::make_stepper_turntable(
      [wire, connect, server = devices.simulated_wire.get(), clock = devices.clock.get()] {
        return connect(open_line(wire, server), *clock, wire.controller);
      },
      *devices.clock, wire.stepper);
}

std::unique_ptr<rig::Camera> make_camera(const RigFile& rig, RigDevices& devices) {
  if (rig.camera_driver == "simulated")
    return rig::make_simulated_camera(*devices.bench, *devices.clock, rig.simulation->camera_make);
  rig::CameraProcessSetup setup{.command = {"/proc/self/exe", kCameraProcess}, .camera = rig.camera_wire->setup};
  if (rig.camera_wire->simulated) {
    start_simulated_camera(rig, devices);
    const std::string port = std::to_string(devices.simulated_camera.network->port());
    setup.camera.port = "ptpip:127.0.0.1:" + port + ":" + port;
  }
  return rig::make_process_camera(setup);
}

std::atomic<int> opened{0};

std::unique_ptr<rig::Turntable> make_turntable(const RigFile& rig, RigDevices& devices, rig::AskedPerson* asked) {
  if (rig.turntable_driver != "simulated") ++opened;
  if (rig.turntable_driver == "simulated") return rig::make_simulated_turntable(*devices.bench, *devices.clock);
  if (rig.turntable_driver != "manual") return make_wired_turntable(rig, devices, asked);
  auto by_hand = rig::make_manual_turntable(*asked);
  return devices.bench ? rig::make_practice_turntable(std::move(by_hand),
                                                      rig::make_simulated_turntable(*devices.bench, *devices.clock))
                       : std::move(by_hand);
}

void connect_camera(const RigFile& rig, RigDevices& devices) {
  devices.camera = on_bench([&] { return throwing_bench_faults(make_camera(rig, devices)); });
}

void connect_turntable(const RigFile& rig, RigDevices& devices, rig::AskedPerson* asked) {
  devices.turntable =
      guard_turntable(on_bench([&] { return throwing_bench_faults(make_turntable(rig, devices, asked)); }));
}

void require_person(const RigFile& rig, const rig::AskedPerson* asked) {
  if (asked || (rig.operator_driver != "console" && rig.turntable_driver != "manual")) return;
  throw std::runtime_error("rig \"" + rig.name + "\" needs a person (" +
                           (rig.operator_driver == "console" ? "operator: console" : "turntable: manual") +
                           "); run without --unattended");
}

// One grey for everything.
cv::Mat3f undrawn(const rig::BenchState& state) {
  return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0.1F));
}

// The clock and, for a simulated device, the bench that nobody draws.
RigDevices undrawn_bench(const RigFile& rig, bool simulated, double pace = 0) {
  RigDevices devices;
  devices.clock = make_clock(simulated, pace);
  if (simulated) devices.bench = std::make_unique<rig::SimulatedBench>(rig.simulation->truth, undrawn);
  return devices;
}

}  // namespace

int turntables_opened() {
  return opened;
}

std::shared_ptr<rig::SimulatedPort> start_firmware(const RigFile& rig, rig::SimulatedBench& bench, rig::Clock& clock,
                                                   const rig::LineFaultPlan& faults) {
  if (!rig.turntable_wire || rig.turntable_wire->line != TurntableWire::Line::simulated)
    throw std::runtime_error("rig \"" + rig.name +
                             "\" names no turntable that is simulated on a wire; give it \"turntable\": \"grbl\" or "
                             "\"zaber\" and \"line\": \"simulated\" in its turntable_setup");
  const rig::ControllerSetup& setup = rig.turntable_wire->controller;
  const rig::SimulatedMotor motor(bench, clock, setup.steps_per_deg);
  return rig::make_simulated_port(
      rig.turntable_driver == "grbl" ? rig::make_simulated_grbl(motor, clock, setup.home_by == rig::HomeBy::home_switch)
                                     : rig::make_simulated_zaber(motor),
      faults);
}

void start_simulated_camera(const RigFile& rig, RigDevices& devices, const rig::CameraFaultPlan& faults) {
  auto& simulated = devices.simulated_camera;
  const rig::CameraMake make = rig.simulation->camera_make;
  simulated.lens = rig::make_simulated_camera(*devices.bench, *devices.clock, make);
  simulated.body = rig::make_simulated_body(*simulated.lens, make);
  if (!rig.simulation->truth.lens.electronic_aperture)
    simulated.body->set_condition({.missing = {rig::aperture_property(make)}});
  simulated.network = rig::serve_on_ptpip(*simulated.body, 0, faults);
}

RigDevices open_rig(const RigFile& rig, const std::optional<Spool>& spool, rig::AskedPerson* asked) {
  require_person(rig, asked);
  const bool simulated = photographs_the_bench(rig);
  if (rig.turntable_driver != "manual" && simulated != turns_the_bench(rig))
    throw std::runtime_error("rig \"" + rig.name + "\" mixes a " + (simulated ? "simulated" : "real") +
                             " camera with a " + (turns_the_bench(rig) ? "simulated" : "real") + " turntable (" +
                             rig.turntable_driver +
                             "), and the pictures would not turn with it; make both real or both simulated, or try one "
                             "alone with \"threadstation check\"");
  if (!simulated && rig.operator_driver == "simulated")
    throw std::runtime_error("rig \"" + rig.name +
                             "\" has real devices and a simulated operator; write \"operator\": \"console\"");
  RigDevices devices;
  devices.clock = make_clock(simulated);
  if (simulated)
    devices.bench = std::make_unique<rig::SimulatedBench>(rig.simulation->truth, make_bench_picture(rig, spool));
  connect_camera(rig, devices);
  connect_turntable(rig, devices, asked);
  if (rig.operator_driver == "console") devices.person = rig::make_console_operator(*asked);
  if (devices.bench) {
    auto hand = rig::make_simulated_operator(*devices.bench);
    devices.person =
        devices.person ? rig::make_practice_operator(std::move(devices.person), std::move(hand)) : std::move(hand);
  }
  return devices;
}

RigDevices open_turntable(const RigFile& rig, rig::AskedPerson* asked) {
  constexpr double kPace = 0.02;  // a check looks at it from another thread while it turns
  require_person(rig, asked);
  RigDevices devices = undrawn_bench(rig, turns_the_bench(rig), kPace);
  connect_turntable(rig, devices, asked);
  return devices;
}

TurntableLine open_turntable_line(const RigFile& rig) {
  if (!rig.turntable_wire)
    throw std::runtime_error("rig \"" + rig.name + "\" has no turntable with a motor controller");
  TurntableLine connected{.devices = undrawn_bench(rig, turns_the_bench(rig)), .line = nullptr};
  start_simulated_wire(rig, connected.devices);
  connected.line = open_line(*rig.turntable_wire, connected.devices.simulated_wire.get());
  return connected;
}

double controller_steps_per_deg(const RigFile& rig) {
  const TurntableLine opened = open_turntable_line(rig);
  rig::ControllerSetup setup = rig.turntable_wire->controller;
  setup.steps_per_deg = 0;
  const auto connect = rig.turntable_driver == "grbl" ? rig::connect_grbl : rig::connect_zaber;
  return connect(opened.line, *opened.devices.clock, setup)->identity().steps_per_deg;
}

RigDevices open_camera(const RigFile& rig) {
  RigDevices devices = undrawn_bench(rig, photographs_the_bench(rig));
  connect_camera(rig, devices);
  return devices;
}

}  // namespace station
