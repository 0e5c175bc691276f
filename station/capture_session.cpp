#include "station/capture_session.h"

#include <cmath>
#include <fstream>
#include <stdexcept>

#include "station/bench_reading.h"
#include "station/calibration_validity.h"
#include "station/capture_checks.h"
#include "station/documents/calibration_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/exposure.h"
#include "station/interrupt.h"
#include "station/rig_devices.h"
#include "station/views.h"

namespace station {
namespace {

// Only times whose true length is known, a stop apart; beyond them the wanted one.
double nearest_measured_s(const calibration::SensorResponse& response, double wanted_s) {
  double nearest_s = wanted_s, least_stops = 0.6;
  for (const calibration::ShutterTime& time : response.shutter) {
    const double stops = std::abs(std::log2(time.nominal_s / wanted_s));
    if (stops < least_stops) nearest_s = time.nominal_s, least_stops = stops;
  }
  return nearest_s;
}

// Views are metered on the threads; pose pictures on the whole frame, for the tags.
ChooseExposure exposure_chooser(const RigFile& rig, const Spool& spool, const RigCalibration& calibration) {
  return [rig, spool, calibration](const PlanStep& step, const rig::Picture& test) -> ExposureChoice {
    const calibration::SensorPicture picture =
        calibration::read_sensor_bytes(test.bytes, "test picture of " + step.id);
    require_same_camera(calibration, picture, "test picture of " + step.id);
    const cv::Mat1b region = step.kind == StepKind::view ? window_region(rig, spool.wrapping, calibration,
                                                                         step.mounting, step.platform_angle_rad)
                                                         : cv::Mat1b();
    const auto next = next_exposure_s(picture, region, {.level = rig.target_level});
    const double wanted_s = next.value_or(picture.exposure_s);
    if (calibration.sensor && step.kind == StepKind::view) {
      const double measured_s = nearest_measured_s(calibration.sensor->response, wanted_s);
      return {.exposure_s = measured_s, .done = std::abs(std::log2(measured_s / picture.exposure_s)) < 0.1};
    }
    // While the holder can still be put right; the reading was checked by the runner.
    if (!next && step.kind == StepKind::pose)
      require_calibrated_bench(calibration, read_bench(calibration, rig, tags_in(picture)), step.platform_angle_rad,
                               "step " + step.id);
    return {.exposure_s = wanted_s, .done = !next};
  };
}

void require_same_sensor(rig::Camera& camera, const calibration::Lens& lens) {
  const rig::CameraIdentity found = camera.identity();
  if (found.width_px != lens.width_px || found.height_px != lens.height_px)
    throw std::runtime_error("the calibration is for pictures of " + std::to_string(lens.width_px) + " x " +
                             std::to_string(lens.height_px) + " pixels, this camera makes " +
                             std::to_string(found.width_px) + " x " + std::to_string(found.height_px) +
                             "; calibrate the rig with this camera");
}

RunOutcome run(SessionFolder& session, RigDevices& devices, const SessionFile& asked,
               const RigCalibration& calibration, ProgressStyle progress_style) {
  ProgressDisplay display("capture", progress_style);
  RunOptions options;
  options.settings.exposure_s = 0.125;
  options.choose_exposure = exposure_chooser(asked.rig, asked.spool, calibration);
  options.inspect = make_inspection(session, asked, calibration);
  options.nominal_holder_pose = [&](rig::Mounting mounting) {
    return nominal_holder_pose(asked.rig, asked.spool.wrapping, mounting);
  };
  options.progress = [&](const Progress& p) {
    display.show(static_cast<int>(p.done), static_cast<int>(p.total), p.step, devices.bench ? -1 : p.seconds_left);
  };
  watch_interrupts();
  options.should_stop = interrupted;
  const StopOnInterrupt emergency([&devices] { devices.turntable->stop(); });
  const RunDevices run_devices{*devices.camera, *devices.turntable, *devices.person, *devices.clock};
  const RunOutcome outcome = run_plan(asked.plan, run_devices, session, options);
  display.finish(outcome == RunOutcome::complete
                     ? "complete: " + session.path().string()
                     : "interrupted; go on with capture --resume --out " + session.path().string());
  return outcome;
}

std::vector<std::byte> read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::byte> bytes(std::filesystem::file_size(file));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream) throw std::runtime_error("cannot read " + file.string() + "; check the disk and its permissions");
  return bytes;
}

CalibrationFiles calibration_files(const std::filesystem::path& folder, const RigCalibration& calibration) {
  const std::string text = read_json_file(folder / "calibration.json").dump(2) + "\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  CalibrationFiles files{{"calibration.json", {bytes, bytes + text.size()}}};
  if (calibration.sensor) {
    SensorSection sensor = *calibration.sensor;
    load_sensor_maps(folder, sensor);  // whole and of this calibration, or refused
    for (const char* name : {kSensorMapsFile, kBadPixelsFile}) files[name] = read_bytes(folder / name);
  }
  return files;
}

}  // namespace

RunOutcome capture_session(const CaptureRequest& request) {
  const nlohmann::json rig_document = read_json_file(request.rig), spool_document = read_json_file(request.spool);
  const RigFile rig = parse_rig(rig_document, request.rig.string());
  const Spool spool = parse_spool(spool_document, request.spool.string());
  const RigCalibration calibration = read_calibration(request.calibration);
  if (is_session(request.out))
    throw std::runtime_error(request.out.string() +
                             " is a session already; choose another folder, or go on with capture --resume");
  const Plan plan = make_capture_plan({.reflection_angles_deg = rig.reflection_angles_deg,
                                       .transmission_angles_deg = rig.transmission_angles_deg,
                                       .bracket_stops = rig.bracket_stops});
  RigDevices devices = open_rig(rig, spool, request.unattended);
  require_valid(calibration, rig, devices.clock->utc(), request.accept_calibration);
  require_same_sensor(*devices.camera, calibration.lens.lens);
  FileSystem disk;
  const std::filesystem::path calibration_folder =
      std::filesystem::is_directory(request.calibration) ? request.calibration : request.calibration.parent_path();
  SessionFolder session = SessionFolder::create(
      request.out, make_session_document(devices.clock->utc(), rig_document, spool_document, plan),
      calibration_files(calibration_folder, calibration), *devices.clock, disk);
  return run(session, devices, read_session_file(request.out), calibration, request.progress_style);
}

RunOutcome resume_session(const std::filesystem::path& folder, bool unattended, ProgressStyle progress_style) {
  const SessionFile asked = read_session_file(folder);
  const RigCalibration calibration = read_calibration(folder / "calibration");
  RigDevices devices = open_rig(asked.rig, asked.spool, unattended);
  require_same_sensor(*devices.camera, calibration.lens.lens);
  FileSystem disk;
  SessionFolder session = SessionFolder::open(folder, *devices.clock, disk);
  return run(session, devices, asked, calibration, progress_style);
}

}  // namespace station
