#include "station/bench/check_rig.h"

#include <algorithm>
#include <exception>
#include <functional>

#include "station/bench/check_picture.h"
#include "station/bench/guarded_turntable.h"
#include "station/bench/rig_devices.h"
#include "station/documents/degree.h"
#include "station/output/interrupt.h"

namespace station {
namespace {
constexpr double kReadByHandDeg = 0.5;  // the scale of a platform that a person turns

std::string turntable_name(const RigFile& rig) {
  if (!rig.turntable_wire) return "turntable (" + rig.turntable_driver + ")";
  const rig::SerialPortChoice& port = rig.turntable_wire->port;
  const std::string place = rig.turntable_wire->line == TurntableWire::Line::simulated ? "a simulated wire"
                            : port.usb_serial.empty()                                  ? port.port
                                                      : "USB serial number " + port.usb_serial;
  return "turntable (" + rig.turntable_driver + " on " + place + ")";
}

double turntable_step_rad(const RigFile& rig) {
  if (rig.turntable_wire) return kDegree / rig.turntable_wire->controller.steps_per_deg;
  if (rig.turntable_driver == "manual") return kReadByHandDeg * kDegree;
  return rig.simulation->truth.turntable.step_rad;
}

void require_not_interrupted(const DeviceCheck& check) {
  if (!interrupted()) return;
  const auto ended = std::ranges::find_if(check.rows, [](const rig::ContractRow& row) { return !row.passed; });
  throw Interrupted("the check was stopped" + (ended == check.rows.end() ? "" : ": " + ended->what));
}

DeviceCheck checked(const std::string& device, const std::function<std::vector<rig::ContractRow>()>& check) {
  try {
    DeviceCheck done{device, check()};
    require_not_interrupted(done);
    return done;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    return {device, {{.name = "it can be connected", .passed = false, .what = error.what()}}};
  }
}

}  // namespace

std::vector<DeviceCheck> check_rig(const RigFile& rig, const std::optional<RigCalibration>& calibration,
                                   rig::AskedPerson& asked) {
  watch_interrupts();
  std::vector<DeviceCheck> checks;
  checks.push_back(checked(turntable_name(rig), [&] {
    const RigDevices devices = open_turntable(rig, &asked);
    return rig::check_turntable(*devices.turntable, turntable_step_rad(rig), rig.turntable_driver != "manual");
  }));
  const std::string port = rig.camera_wire ? " at " + rig.camera_wire->setup.port : "";
  checks.push_back(checked("camera (" + rig.camera_driver + port + ")", [&] {
    const RigDevices devices = open_camera(rig);
    return rig::check_camera(*devices.camera);
  }));
  const bool sound = std::ranges::all_of(checks, [](const DeviceCheck& one) { return rig::all_passed(one.rows); });
  if (calibration && sound)
    checks.push_back(
        checked("test picture", [&] { return check_picture(open_rig(rig, std::nullopt, &asked), rig, *calibration); }));
  return checks;
}

}  // namespace station
