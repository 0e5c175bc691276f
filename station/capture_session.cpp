#include "station/capture_session.h"

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "station/calibration_validity.h"
#include "station/capture/plan_file.h"
#include "station/documents/calibration_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/drawing_operator.h"
#include "station/interrupt.h"
#include "station/replay/device_log.h"
#include "station/rig_devices.h"
#include "station/run_session.h"

namespace station {
namespace {

void require_same_sensor(rig::Camera& camera, const calibration::Lens& lens) {
  const rig::CameraIdentity found = camera.identity();
  if (found.width_px != lens.width_px || found.height_px != lens.height_px)
    throw std::runtime_error("the calibration is for pictures of " + std::to_string(lens.width_px) + " x " +
                             std::to_string(lens.height_px) + " pixels, this camera makes " +
                             std::to_string(found.width_px) + " x " + std::to_string(found.height_px) +
                             "; calibrate the rig with this camera");
}

StopWish wish() {
  return interrupts() == 0 ? StopWish::none : interrupts() == 1 ? StopWish::pause : StopWish::now;
}

// The second ctrl-C: the stop is on the disk before anything else, and nobody waits for a device that hangs.
[[noreturn]] void stop_now(SessionFolder& session, RigDevices& devices) {
  try {
    session.append_last("stop", {{"outcome", state_name(RunState::aborted)}});
  } catch (...) {
  }
  try {
    devices.turntable->stop();
  } catch (...) {
  }
  std::fputs("threadstation: capture was stopped at once; go on with capture --resume\n", stderr);
  ::_exit(1);
}

// Uncompressed pictures of 16 bits, and as much again for what is made of them; before anything is written.
void require_space(const std::filesystem::path& out, const Plan& plan, const calibration::Lens& lens) {
  constexpr double kHeader_bytes = 65536;
  const double needed =
      static_cast<double>(plan.steps.size()) * (2.0 * lens.width_px * lens.height_px + kHeader_bytes);
  std::filesystem::path place = std::filesystem::absolute(out);
  std::error_code code;
  while (!std::filesystem::exists(place, code) && place.has_relative_path()) place = place.parent_path();
  const auto space = std::filesystem::space(place, code);
  if (code || static_cast<double>(space.available) >= 2 * needed) return;
  const auto megabytes = [](double bytes) { return std::to_string(static_cast<long>(bytes / 1e6)) + " MB"; };
  throw std::runtime_error("'" + out.string() + "' would need " + megabytes(2 * needed) +
                           " (pictures and what is made of " + "them) and its disk has " +
                           megabytes(static_cast<double>(space.available)) +
                           " free; free space there or choose another disk");
}

std::string last_line(RunState state, const std::string& session) {
  return state == RunState::complete ? "complete: " + session
                                     : state_name(state) + "; go on with capture --resume --out " + session;
}

RunState run(SessionFolder& session, RigDevices& devices, const SessionFile& asked, const RigCalibration& calibration,
             const ResumeRequest& request) {
  ProgressDisplay display("capture", request.progress_style);
  SessionRun run{
      .reshoot = request.reshoot, .record = request.record || is_recorded(session.path()), .stop_wish = wish};
  run.progress = [&](const Progress& p) {
    display.show(static_cast<int>(p.done), static_cast<int>(p.total), p.step, devices.bench ? -1 : p.seconds_left);
  };
  run.judged = [&](const PlanStep& step, const Verdict& verdict) {
    if (verdict.grade() == Grade::doubtful) display.note(step.id + " is doubtful: " + verdict.reason());
    if (verdict.grade() == Grade::bad && verdict.may_pass_again())
      display.note(step.id + " is refused: " + verdict.reason());
  };
  run.said = [&](const std::string& line) { display.note(line); };
  watch_interrupts(2);
  const StopOnInterrupt emergency(
      [&] {
        devices.turntable->stop();
        display.note("pausing after the picture under way; ctrl-C again stops at once");
      },
      [&] { stop_now(session, devices); });
  std::unique_ptr<rig::Operator> drawing;
  if (asked.rig.operator_driver == "console")
    drawing = make_drawing_operator(*devices.person, std::cout, request.progress_style == ProgressStyle::json);
  const RunDevices run_devices{*devices.camera, *devices.turntable, drawing ? *drawing : *devices.person,
                               *devices.clock};
  const RunState state = run_session(session, run_devices, asked, calibration, run);
  display.finish(last_line(state, session.path().string()));
  return state;
}

std::vector<std::byte> read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::byte> bytes(std::filesystem::file_size(file));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream) throw std::runtime_error("cannot read " + file.string() + "; check the disk and its permissions");
  return bytes;
}

}  // namespace

CalibrationFiles calibration_files(const std::filesystem::path& place, const RigCalibration& calibration) {
  const std::filesystem::path document = calibration_document(place), folder = document.parent_path();
  const std::string text = read_json_file(document).dump(2) + "\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  CalibrationFiles files{{"calibration.json", {bytes, bytes + text.size()}}};
  if (calibration.sensor) {
    SensorSection sensor = *calibration.sensor;
    load_sensor_maps(folder, sensor);  // whole and of this calibration, or refused
    for (const char* name : {kSensorMapsFile, kBadPixelsFile}) files[name] = read_bytes(folder / name);
  }
  return files;
}

Plan plan_of(const RigFile& rig, const Spool& spool) {
  const PlanRequest request{.reflection_angles_deg = rig.reflection_angles_deg,
                            .transmission_angles_deg = rig.transmission_angles_deg,
                            .bracket_stops = rig.bracket_stops,
                            .brackets_if_needed = rig.brackets_if_needed};
  return spool.fabric ? make_fabric_plan(request) : make_capture_plan(request);
}

RunState capture_session(const CaptureRequest& request) {
  const nlohmann::json rig_document = read_json_file(request.rig);
  nlohmann::json spool_document = read_spool_document(request.spool);
  if (request.sample && spool_document.is_object()) {
    if (!request.sample->name.empty()) spool_document["name"] = request.sample->name;
    if (!request.sample->material.empty()) spool_document["material"] = request.sample->material;
  }
  const RigFile rig = parse_rig(rig_document, request.rig.string());
  const Spool spool = parse_spool(spool_document, request.spool.string());
  const RigCalibration calibration = read_calibration(request.calibration);
  if (is_session(request.out))
    throw std::runtime_error(request.out.string() +
                             " is a session already; choose another folder, or go on with capture --resume");
  const Plan plan = request.plan.empty() ? plan_of(rig, spool)
                                         : plan_from_json(read_json_file(request.plan), request.plan.string());
  require_space(request.out, plan, calibration.lens.lens);
  RigDevices devices = open_rig(rig, spool, request.unattended);
  require_valid(calibration, rig, devices.clock->utc(), request.accept_calibration);
  require_same_sensor(*devices.camera, calibration.lens.lens);
  FileSystem disk;
  SessionFolder session = SessionFolder::create(
      request.out,
      make_session_document(devices.clock->utc(), rig_document, spool_document, plan, request.person, request.sample),
      calibration_files(request.calibration, calibration), *devices.clock, disk);
  return run(session, devices, read_session_file(request.out), calibration,
             {.session = request.out,
              .unattended = request.unattended,
              .record = request.record,
              .reshoot = {},
              .progress_style = request.progress_style});
}

RunState resume_session(const ResumeRequest& request) {
  const SessionFile asked = read_session_file(request.session);
  steps_to_reshoot(asked.plan, request.reshoot);  // before any device is asked
  const RigCalibration calibration = read_calibration(request.session / "calibration");
  RigDevices devices = open_rig(asked.rig, asked.spool, request.unattended);
  require_same_sensor(*devices.camera, calibration.lens.lens);
  FileSystem disk;
  SessionFolder session = SessionFolder::open(request.session, *devices.clock, disk);
  return run(session, devices, asked, calibration, request);
}

}  // namespace station
