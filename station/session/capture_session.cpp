#include "station/session/capture_session.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include "station/bench/bench_fault.h"
#include "station/bench/calibration_validity.h"
#include "station/bench/drawing_operator.h"
#include "station/bench/guarded_turntable.h"
#include "station/bench/platform_memory.h"
#include "station/bench/rig_devices.h"
#include "station/documents/calibration_file.h"
#include "station/documents/degree.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/number_text.h"
#include "station/documents/plan_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/output/interrupt.h"
#include "station/session/run_session.h"

namespace station {
namespace {

void require_same_sensor(rig::Camera& camera, const calibration::Lens& lens) {
  const rig::CameraIdentity found = camera.identity();
  if (found.width_px != lens.width_px || found.height_px != lens.height_px)
    throw BenchFault("the calibration is for pictures of " + std::to_string(lens.width_px) + " x " +
                     std::to_string(lens.height_px) + " pixels, this camera makes " + std::to_string(found.width_px) +
                     " x " + std::to_string(found.height_px) + "; calibrate the rig with this camera");
}

StopWish wish() {
  return interrupts() == 0 ? StopWish::none : interrupts() == 1 ? StopWish::pause : StopWish::now;
}

// Ends the process at the second ctrl-C. The stop of a session under way is on the disk before anything else. A
// platform that turns is given some seconds to stand and to say where; nobody waits longer for a device that hangs.
[[noreturn]] void stop_now(SessionFolder* session, RigDevices& devices) {
  try {
    if (session) session->append_last("stop", {{"outcome", state_name(RunState::aborted)}});
  } catch (...) {
  }
  try {
    devices.turntable->stop();
    for (int looks = 0; looks < 200 && devices.turntable->state() == rig::TurntableState::moving; ++looks)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
  } catch (...) {
  }
  std::fputs(session ? "threadstation: capture was stopped at once; go on with capture --resume\n"
                     : "threadstation: the platform was stopped on its way back to 0; the session is complete\n",
             stderr);
  ::_exit(1);
}

// Refuses a disk without room for the plan's uncompressed pictures of 16 bits, and as much again for what is made of
// them, before anything is written.
void require_space(const std::filesystem::path& out, const Plan& plan, const calibration::Lens& lens) {
  constexpr double kHeader_bytes = 65536;
  const double needed = static_cast<double>(plan.steps.size()) * (2.0 * lens.width_px * lens.height_px + kHeader_bytes);
  std::filesystem::path place = std::filesystem::absolute(out);
  std::error_code code;
  while (!std::filesystem::exists(place, code) && place.has_relative_path()) place = place.parent_path();
  const auto space = std::filesystem::space(place, code);
  if (code || static_cast<double>(space.available) >= 2 * needed) return;
  const auto megabytes = [](double bytes) { return std::to_string(static_cast<long>(bytes / 1e6)) + " MB"; };
  throw std::runtime_error("'" + out.string() + "' would need " + megabytes(2 * needed) +
                           " (pictures and what is made of them) and its disk has " +
                           megabytes(static_cast<double>(space.available)) +
                           " free; free space there or choose another disk");
}

std::string last_line(RunState state, const std::string& session) {
  return state == RunState::complete ? "complete: " + session
                                     : state_name(state) + "; go on with capture --resume --out " + session;
}

// Which of the two is right can only be told by somebody who looks.
std::optional<double> ask_where_it_stands(rig::AskedPerson* asked, double reading_rad, double tags_rad) {
  if (asked == nullptr) return std::nullopt;
  const auto degrees = [](double angle_rad) { return number_text(angle_rad / kDegree, 1) + " deg"; };
  const rig::Question question{
      .text = "The tags on the platform show that it stands at " + degrees(tags_rad) +
              ", and the turntable remembers that it left it at " + degrees(reading_rad) +
              ". Was it turned by hand meanwhile, so that the tags are right?",
      .how = "Press Enter when the tags are right, or q and Enter to end and look what slipped: ",
      .choices = {{rig::kDone, "", "The tags are right"}, {rig::kDecline, "q", "End: I look what slipped"}}};
  return asked->ask(question) == rig::kDone ? std::optional(tags_rad) : std::nullopt;
}

RunState run(SessionFolder& session, RigDevices& devices, const SessionFile& asked, const RigCalibration& calibration,
             const CaptureRequest& request) {
  ProgressDisplay display("capture", request.progress_style);
  RunOptions options;
  options.stop_wish = wish;
  options.progress = [&](const Progress& p) {
    if (request.asked) request.asked->prepare({{"step", p.done + 1}, {"of", p.total}}, "");
    display.show(static_cast<int>(p.done), static_cast<int>(p.total), p.step, devices.bench ? -1 : p.seconds_left);
  };
  options.judged = [&](const PlanStep& step, const Verdict& verdict) {
    if (verdict.grade() == Grade::doubtful) display.note(step.id + " is doubtful: " + verdict.reason());
    if (verdict.grade() == Grade::bad && verdict.may_pass_again())
      display.note(step.id + " is refused: " + verdict.reason());
  };
  options.said = [&](const std::string& line) { display.note(line); };
  if (remembers_its_place(asked.rig))
    options.settle_place = [&](double reading_rad, double differ_rad) {
      return ask_where_it_stands(request.asked, reading_rad, reading_rad + differ_rad / calibration.platform.scale);
    };
  watch_more_interrupts(2);
  std::atomic<bool> taken = false;
  const StopOnInterrupt emergency(
      [&] {
        if (!taken) display.note("pausing after the picture under way; ctrl-C again stops at once");
      },
      [&] { stop_now(taken ? nullptr : &session, devices); });
  std::unique_ptr<rig::Operator> drawing;
  if (asked.rig.operator_driver == "console") drawing = make_drawing_operator(*devices.person, *request.asked);
  const RunDevices run_devices{*devices.camera, *devices.turntable, drawing ? *drawing : *devices.person,
                               *devices.clock};
  const RunState state = run_session(session, run_devices, asked, calibration, request, options);
  taken = state == RunState::complete;
  try {
    if (taken) leave_at_zero(asked.rig, *devices.turntable);
  } catch (const Interrupted& stopped) {
    display.note(stopped.what());  // nothing of the session is missing
  }
  display.finish(last_line(state, session.path().string()));
  return state;
}

RunState begin_session(const CaptureRequest& request, const NewSession& made_of) {
  const nlohmann::json rig_document = read_json_file(made_of.rig);
  nlohmann::json spool_document = read_spool_document(made_of.spool);
  if (made_of.sample && spool_document.is_object()) {
    if (!made_of.sample->name.empty()) spool_document["name"] = made_of.sample->name;
    if (!made_of.sample->material.empty()) spool_document["material"] = made_of.sample->material;
  }
  const RigFile rig = parse_rig(rig_document, made_of.rig.string());
  const Spool spool = parse_spool(spool_document, made_of.spool.string());
  const RigCalibration calibration = on_bench([&] { return read_calibration(made_of.calibration); });
  if (is_session(request.session))
    throw std::runtime_error(request.session.string() +
                             " is a session already; choose another folder, or go on with capture --resume");
  const Plan plan = on_bench([&] {
    return made_of.plan.empty() ? plan_of(rig, spool)
                                : plan_from_json(read_json_file(made_of.plan), made_of.plan.string());
  });
  require_space(request.session, plan, calibration.lens.lens);
  RigDevices devices = open_rig(rig, spool, request.asked);
  on_bench([&] { require_valid(calibration, rig, devices.clock->utc(), made_of.accept_calibration); });
  require_same_sensor(*devices.camera, calibration.lens.lens);
  FileSystem disk;
  SessionFolder session = SessionFolder::create(
      request.session,
      make_session_document(devices.clock->utc(), rig_document, spool_document, plan, made_of.person, made_of.sample),
      on_bench([&] { return calibration_files(made_of.calibration, calibration); }), *devices.clock, disk);
  return run(session, devices, read_session_file(request.session), calibration, request);
}

RunState resume_session(const CaptureRequest& request) {
  const SessionFile asked = read_session_file(request.session);
  require_captured(asked, request.session, "there is nothing to go on with");
  steps_to_reshoot(asked.plan, request.reshoot);  // before any device is asked
  const RigCalibration calibration = read_calibration(request.session / "calibration");
  RigDevices devices = open_rig(asked.rig, asked.spool, request.asked);
  require_same_sensor(*devices.camera, calibration.lens.lens);
  FileSystem disk;
  SessionFolder session = SessionFolder::open(request.session, *devices.clock, disk);
  return run(session, devices, asked, calibration, request);
}

}  // namespace

CalibrationFiles calibration_files(const std::filesystem::path& place, const RigCalibration& calibration) {
  const std::filesystem::path document = calibration_document(place), folder = document.parent_path();
  const std::string text = read_json_file(document).dump(2) + "\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  CalibrationFiles files{{"calibration.json", {bytes, bytes + text.size()}}};
  if (calibration.sensor && has_map_files(*calibration.sensor)) {
    RigCalibration whole = calibration;
    fill_in_sensor_maps(folder, whole);  // whole and of this calibration, or refused
    for (const char* name : {kSensorMapsFile, kBadPixelsFile}) files[name] = bytes_of_file(folder / name);
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
  return request.new_session ? begin_session(request, *request.new_session) : resume_session(request);
}

}  // namespace station
