#include "station/bench/calibrate/calibrate_rig.h"

#include <stdexcept>

#include "station/bench/calibrate/calibration_report.h"
#include "station/bench/calibrate/placing_watch.h"
#include "station/bench/drawing_operator.h"
#include "station/bench/platform_memory.h"
#include "station/bench/rig_devices.h"
#include "station/documents/lens_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/output/interrupt.h"

namespace station {

RigCalibration calibrate_rig(const CalibrateRequest& request) {
  const RigFile rig = read_rig(request.rig);
  ProgressDisplay progress("photograph", request.progress_style);
  std::vector<CalibrationStep> plan = make_calibration_plan(rig);
  // A person counts what is left to do, not pictures.
  const auto show_step = [&](int done, int total, const std::string& label) {
    const std::vector<int> actions = actions_of(plan);
    if (request.asked && done < total)
      request.asked->prepare({{"step", actions.at(static_cast<std::size_t>(done))}, {"of", actions.back()}}, "");
    progress.show(done, total, label);
  };
  if (!request.solve_only) {
    watch_interrupts();
    if (!request.only.empty())
      forget_calibration_pictures(request.out, [&](CalibrationRole role) { return part_of(role) == request.only; });
    LensCoverage covered(rig);
    std::optional<WatchedPerson> watched;
    if (request.asked) watched.emplace(*request.asked);
    RigDevices devices = open_rig(rig, std::nullopt, watched ? &*watched : nullptr);
    std::unique_ptr<rig::Operator> person;  // behind its drawing, which a program makes
    if (rig.operator_driver == "console" && request.progress_style == ProgressStyle::json_lines) {
      person = std::move(devices.person);
      devices.person = make_drawing_operator(*person, *request.asked);
    }
    if (watched && rig.operator_driver == "console" && !request.live.empty())
      watch_placing(rig, devices, request.live, *watched, covered);
    record_calibration(rig, plan, devices, request.out, show_step, interrupted, covered);
    progress.finish("all pictures are taken");
    leave_at_zero(rig, *devices.turntable);
  }
  if (interrupted()) throw std::runtime_error("calibration interrupted; the same command goes on from here");
  let_interrupts_end();  // all pictures are kept, and to solve them takes long
  const std::vector<CalibrationPicture> pictures = read_calibration_pictures(request.out);
  ProgressDisplay working_out("work out", request.progress_style);
  RigCalibration calibration =
      solve_calibration(rig, request.out, pictures,
                        [&](int done, int total, const std::string& label) { working_out.show(done, total, label); });
  calibration.utc = oldest_part_utc(pictures);
  calibration.software = software_version();
  if (calibration.sensor) write_sensor_maps(request.out, *calibration.sensor);
  write_json_file(request.out / "calibration.json", to_json(calibration));
  write_cameramodel_beside(calibration.lens, request.out / "calibration.json");
  write_calibration_page(request.out, calibration);
  working_out.finish("done");
  return calibration;
}

}  // namespace station
