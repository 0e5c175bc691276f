#include "tests/station/commands/simulated_hardware.h"

#include <csignal>
#include <stdexcept>

#include "station/documents/reader.h"
#include "tests/places.h"

namespace station_test {

SimulatedHardware::SimulatedHardware(const nlohmann::json& rig, const std::string& faults) {
  station::write_json_file(folder_ / "rig.json", rig);
  const std::string ports = folder_ / "ports", program = THREADSTATION_PROGRAM;
  const ProgramResult started =
      run_shell(program + " simulate-hardware --json --rig " + (folder_ / "rig.json").string() +
                (faults.empty() ? "" : " --faults " + faults) + " > " + ports + " & echo $!; while [ ! -s " + ports +
                " ]; do kill -0 $! || exit 1; sleep 0.05; done");
  if (started.status != 0) throw std::runtime_error("no simulated hardware: " + started.error);
  process_ = std::stoi(started.out);
  ports_ = station::read_json_file(ports);
}

SimulatedHardware::~SimulatedHardware() {
  ::kill(process_, SIGINT);
}

std::string SimulatedHardware::turntable_port() const {
  return ports_.contains("turntable") ? ports_["turntable"].at("port").get<std::string>() : "";
}

std::string SimulatedHardware::camera_port() const {
  return ports_.contains("camera") ? ports_["camera"].at("port").get<std::string>() : "";
}

}  // namespace station_test
