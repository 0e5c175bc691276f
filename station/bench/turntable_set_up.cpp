#include "station/bench/turntable_set_up.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "station/bench/rig_devices.h"
#include "station/documents/reader.h"
#include "station/documents/turntable_settings_file.h"

namespace station {
namespace {

constexpr double kPrinted = 0.001;  // the firmware prints three decimals
constexpr int kHoming = 22;         // soft limits can only be switched on after it, and go off with it

void require_grbl(const RigFile& rig) {
  if (rig.turntable_driver == "grbl") return;
  throw std::runtime_error(
      rig.turntable_driver == "zaber"
          ? "rig \"" + rig.name +
                "\" has a Zaber stage, which needs no such set-up: it knows its "
                "motor and its home, and \"resolution\" in the rig file is what it is checked against"
          : "rig \"" + rig.name + "\" has a turntable without a GRBL controller (" + rig.turntable_driver +
                "), which has no settings to set up");
}

void require_sense(const SetUpRequest& request) {
  const bool restore = !request.restore.empty();
  if (request.write && restore) throw std::runtime_error("--write and --restore exclude each other; give one of them");
  if (restore && !request.back_up.empty())
    throw std::runtime_error("--restore puts a back-up's settings back and makes none; leave out --back-up");
  if (request.write && request.back_up.empty())
    throw std::runtime_error("--write needs --back-up FILE, a new file for the settings as they are now");
  if (!request.write && !request.back_up.empty())
    throw std::runtime_error("--back-up goes with --write; nothing is changed without it");
  if (request.write && std::filesystem::exists(request.back_up))
    throw std::runtime_error("the back-up " + request.back_up.string() +
                             " exists already and is not overwritten; give it another name");
}

bool same(double a, double b) {
  return std::abs(a - b) <= kPrinted;
}

// What a setting is to become: where it differs from what is needed, or from the back-up.
std::map<int, double> changes(const std::vector<rig::GrblSettingRow>& rows) {
  std::map<int, double> to_write;
  for (const rig::GrblSettingRow& row : rows)
    if (row.needed) to_write[row.number] = *row.needed;
  return to_write;
}

std::map<int, double> changes(const rig::GrblSettings& now, const TurntableSettings& back_up,
                              const std::string& firmware) {
  if (back_up.firmware != firmware)
    throw std::runtime_error("the back-up is of another controller: it was \"" + back_up.firmware +
                             "\", and this is \"" + firmware + "\"; choose the back-up of this one");
  std::map<int, double> to_write;
  for (const auto& [number, value] : back_up.settings)
    if (now.contains(number) && !same(now.at(number), value)) to_write[number] = value;
  return to_write;
}

void write(rig::GrblSettingsPort& port, const std::map<int, double>& to_write) {
  if (to_write.contains(kHoming)) port.write_setting(kHoming, to_write.at(kHoming));
  for (const auto& [number, value] : to_write)
    if (number != kHoming) port.write_setting(number, value);
}

void require_kept(const std::map<int, double>& written, const rig::GrblSettings& now) {
  for (const auto& [number, value] : written) {
    if (now.contains(number) && same(now.at(number), value)) continue;
    throw std::runtime_error("the turntable was told " + rig::grbl_setting_line(number, value) + " and " +
                             (now.contains(number) ? "has " + rig::grbl_setting_line(number, now.at(number))
                                                   : "no longer says that setting") +
                             "; look into its manual how that setting is changed");
  }
}

// The rows that are needed, and those that a back-up changes beside them.
std::vector<SetUpRow> report_rows(const std::vector<rig::GrblSettingRow>& rows, const std::map<int, double>& written,
                                  const rig::GrblSettings& before, const rig::GrblSettings& after) {
  std::map<int, SetUpRow> report;
  for (const rig::GrblSettingRow& row : rows)
    report[row.number] = {row.number, row.meaning, row.now, row.expected, row.needed, std::nullopt};
  for (const auto& [number, value] : written) {
    SetUpRow& row = report.try_emplace(number, SetUpRow{number, "", before.at(number), "", {}, {}}).first->second;
    row.after = after.at(number);
  }
  std::vector<SetUpRow> list;
  for (auto& [number, row] : report) list.push_back(std::move(row));
  return list;
}

}  // namespace

SetUpReport set_up_turntable(rig::GrblSettingsPort& port, const rig::ControllerSetup& setup,
                             const SetUpRequest& request) {
  require_sense(request);
  const bool restore = !request.restore.empty();
  std::optional<TurntableSettings> back_up;
  if (restore) back_up = read_turntable_settings(request.restore);
  const rig::GrblFirmware firmware = port.firmware();
  const rig::GrblSettings before = port.read_settings();
  const auto rows = rig::grbl_setting_rows(before, setup, firmware);
  const bool homes = setup.home_by == rig::HomeBy::here || rig::grbl_homing_command(setup, firmware);
  std::map<int, double> written;
  rig::GrblSettings after = before;
  if (request.write || restore) {
    written = back_up ? changes(before, *back_up, firmware.name) : changes(rows);
    if (firmware.kind == rig::GrblFirmware::Kind::fluidnc && !written.empty())
      throw std::runtime_error("FluidNC keeps its settings in its configuration file (config.yaml); change them there");
    if (request.write) write_json_file(request.back_up, to_json(TurntableSettings{firmware.name, before}));
    write(port, written);
    after = port.read_settings();
    require_kept(written, after);
  }
  return {firmware.name, report_rows(rows, written, before, after), homes ? "" : rig::grbl_homing_problem()};
}

SetUpReport set_up_turntable(const RigFile& rig, const SetUpRequest& request) {
  require_grbl(rig);
  require_sense(request);
  const TurntableLine opened = open_turntable_line(rig);
  const rig::ControllerSetup& setup = rig.turntable_wire->controller;
  const auto port = rig::connect_grbl_settings(opened.line, *opened.devices.clock, setup);
  return set_up_turntable(*port, setup, request);
}

}  // namespace station
