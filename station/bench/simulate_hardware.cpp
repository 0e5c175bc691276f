#include "station/bench/simulate_hardware.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "station/bench/rig_devices.h"

namespace station {
namespace {

constexpr double kLookEveryS = 0.05;

// Grey, with a bright column that crosses the picture once as the platform turns once.
cv::Mat3f marked(const rig::BenchState& state) {
  cv::Mat3f picture(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0.1F));
  const double turns = state.platform_angle_rad / (2 * std::numbers::pi);
  const int column = static_cast<int>((turns - std::floor(turns)) * (picture.cols - 1));
  picture.col(column).setTo(cv::Vec3f::all(1));
  return picture;
}

}  // namespace

void simulate_hardware(const RigFile& rig, const Faults& faults,
                       const std::function<void(const SimulatedPorts&)>& started,
                       const std::function<bool()>& should_stop) {
  const bool camera = rig.camera_wire && rig.camera_wire->simulated;
  const bool turntable = rig.turntable_wire && rig.turntable_wire->line == TurntableWire::Line::simulated;
  if (!camera && !turntable)
    throw std::runtime_error("rig \"" + rig.name +
                             "\" names nothing that is simulated on a wire; give its turntable_setup \"line\": "
                             "\"simulated\" or its camera_connection \"port\": \"simulated\"");
  RigDevices devices;
  devices.clock = std::make_unique<rig::SystemClock>();
  devices.bench = std::make_unique<rig::SimulatedBench>(rig.simulation->truth, marked);
  SimulatedPorts ports;
  if (turntable) {
    devices.simulated_wire = rig::serve_on_pty(start_firmware(rig, *devices.bench, *devices.clock, faults.turntable));
    ports.turntable = devices.simulated_wire->path();
  }
  if (camera) {
    start_simulated_camera(rig, devices, faults.camera);
    const std::string port = std::to_string(devices.simulated_camera.network->port());
    ports.camera = "ptpip:127.0.0.1:" + port + ":" + port;
  }
  started(ports);
  while (!should_stop()) devices.clock->sleep_s(kLookEveryS);
}

}  // namespace station
