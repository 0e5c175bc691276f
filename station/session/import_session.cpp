#include "station/session/import_session.h"

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include "station/bench/metering.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/lens_file.h"
#include "station/documents/plan_file.h"
#include "station/documents/reader.h"
#include "station/session/capture_session.h"
#include "station/session/run_session.h"

namespace station {
namespace fs = std::filesystem;
namespace {

constexpr double kTape_mm = 10;        // standard error
constexpr double kFocalLength = 0.02;  // standard error, relative: EXIF is in whole millimetres, engravings are round

struct ListedPicture {
  ImportedPicture shown;
  calibration::SensorPicture raw;  // the first picture's has its mosaic
};

std::vector<ListedPicture> read_listed(const ImportFile& import) {
  std::vector<ListedPicture> pictures;
  for (const ImportedPicture& shown : import.pictures) {
    pictures.push_back({shown, calibration::read_sensor_file(shown.file)});
    ListedPicture& last = pictures.back();
    const calibration::SensorPicture &raw = last.raw, &first = pictures.front().raw;
    const bool sizes = pictures.size() == 1 || raw.mosaic.size() == first.mosaic.size();
    if (!sizes || raw.model != first.model || raw.serial != first.serial || raw.iso != first.iso ||
        raw.f_number != first.f_number)
      throw std::runtime_error("'" + shown.file.string() + "' was taken by " + raw.model + " " + raw.serial +
                               " at ISO " + std::to_string(raw.iso) + ", f/" + nlohmann::json(raw.f_number).dump() +
                               ", '" + pictures.front().shown.file.string() + "' by " + first.model + " " +
                               first.serial + " at ISO " + std::to_string(first.iso) + ", f/" +
                               nlohmann::json(first.f_number).dump() +
                               "; a session has one camera, size, ISO and aperture");
    if (pictures.size() > 1) last.raw.mosaic.release();
  }
  return pictures;
}

// Hands out the listed file of what the turntable and the operator were asked for.
class HandTakenPictures {
 public:
  explicit HandTakenPictures(std::vector<ListedPicture> pictures) : pictures_(std::move(pictures)) {}

  rig::CameraIdentity identity() const {
    const calibration::SensorPicture& first = pictures_.front().raw;
    return {.make = first.make,
            .model = first.model,
            .serial = first.serial,
            .width_px = first.mosaic.cols,
            .height_px = first.mosaic.rows};
  }
  std::vector<double> exposures_s() const {
    std::set<double> times_s;
    for (const ListedPicture& picture : pictures_) times_s.insert(picture.raw.exposure_s);
    return {times_s.begin(), times_s.end()};
  }

  // Two listed pictures of the same scenery are handed out one after the other.
  rig::Picture take() {
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      const ListedPicture& picture = pictures_[i];
      if (given_.contains(i) || !shows_what_is_asked(picture)) continue;
      given_.insert(i);
      std::string extension = picture.shown.file.extension().string();
      if (!extension.empty()) extension.erase(0, 1);
      return {.bytes = bytes_of_file(picture.shown.file),
              .extension = extension,
              .settings = settings_of(picture),
              .utc = utc_of(picture.raw.date_time)};
    }
    throw std::runtime_error("no listed picture is left for what is asked next (" + mounting_name(wanted.mounting) +
                             ", lamp " + lamp_name(wanted.lamp) + ", " +
                             nlohmann::json(file_degrees(angle_rad)).dump() +
                             " deg); list one more, or correct the list");
  }

  rig::CameraSettings settings;
  rig::Arrangement wanted;
  double angle_rad = 0;

 private:
  bool shows_what_is_asked(const ListedPicture& picture) const {
    const ImportedPicture& shown = picture.shown;
    if (shown.kind == StepKind::dark)
      return wanted.lamp == rig::Lamp::off && !wanted.room_light && same_settings(settings, settings_of(picture));
    return shown.lamp == wanted.lamp && shown.mounting == wanted.mounting &&
           (shown.kind == StepKind::pose) == wanted.room_light && std::abs(shown.platform_angle_rad - angle_rad) < 1e-9;
  }
  static rig::CameraSettings settings_of(const ListedPicture& picture) {
    return {.exposure_s = picture.raw.exposure_s, .iso = picture.raw.iso, .f_number = picture.raw.f_number};
  }
  // `date_time` is "2026:11:21 10:20:30", by the camera's own clock.
  static std::string utc_of(const std::string& date_time) {
    std::string utc = date_time;
    if (utc.size() != 19) return "1970-01-01T00:00:00.000Z";
    utc[4] = utc[7] = '-', utc[10] = 'T';
    return utc + ".000Z";
  }

  std::vector<ListedPicture> pictures_;
  std::set<std::size_t> given_;
};

class HandCamera final : public rig::Camera {
 public:
  explicit HandCamera(HandTakenPictures& pictures) : pictures_(pictures) {}
  rig::CameraIdentity identity() override { return pictures_.identity(); }
  std::vector<double> shutter_times_s() override { return pictures_.exposures_s(); }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override { return pictures_.settings = wanted; }
  rig::Picture capture() override { return pictures_.take(); }
  std::vector<std::byte> preview() override {
    throw std::runtime_error("pictures that were taken by hand have no live picture; look through the camera");
  }

 private:
  HandTakenPictures& pictures_;
};

class HandTurned final : public rig::Turntable {
 public:
  explicit HandTurned(HandTakenPictures& pictures) : pictures_(pictures) {}
  void home() override { pictures_.angle_rad = 0; }
  void move_to(double angle_rad) override { pictures_.angle_rad = angle_rad; }
  void stop() override {}
  double angle_rad() override { return pictures_.angle_rad; }
  rig::TurntableState state() override { return rig::TurntableState::idle; }

 private:
  HandTakenPictures& pictures_;
};

class HandArranged final : public rig::Operator {
 public:
  explicit HandArranged(HandTakenPictures& pictures) : pictures_(pictures) {}
  void arrange(const rig::Arrangement& wanted) override { pictures_.wanted = wanted; }

 private:
  HandTakenPictures& pictures_;
};

std::string id_of(const ImportedPicture& picture, std::map<std::string, int>& counted) {
  const std::string mounting = mounting_name(picture.mounting);
  const std::string name = picture.kind == StepKind::pose    ? "pose-" + mounting
                           : picture.lamp == rig::Lamp::back ? "transmission-" + mounting
                                                             : "reflection-" + mounting;
  return name + "-" + std::to_string(++counted[name]);
}

bool same_exposure(double a_s, double b_s) {
  return same_settings({.exposure_s = a_s}, {.exposure_s = b_s});
}

void add_darks(Plan& plan, const ImportFile& import, const std::vector<double>& exposures_s) {
  std::vector<PlanStep> darks;
  std::set<std::size_t> used;
  for (const PlanStep& view : plan.steps) {
    if (view.kind != StepKind::view) continue;
    for (std::size_t i = 0; i < import.pictures.size(); ++i) {
      if (import.pictures[i].kind != StepKind::dark || !same_exposure(exposures_s[i], *view.exposure_s)) continue;
      used.insert(i);
      PlanStep dark{.id = "dark-" + view.id, .kind = StepKind::dark, .mounting = view.mounting};
      dark.exposure_of = view.id;
      darks.push_back(dark);
      break;
    }
  }
  for (std::size_t i = 0; i < import.pictures.size(); ++i)
    if (import.pictures[i].kind == StepKind::dark && !used.contains(i))
      throw std::runtime_error("'" + import.pictures[i].file.string() + "' is a dark of " +
                               nlohmann::json(exposures_s[i]).dump() +
                               " s, and no view has that exposure (or another dark serves it); leave it out");
  plan.steps.insert(plan.steps.end(), darks.begin(), darks.end());
}

struct KnownFocalLength {
  double px = 0;
  std::string from;
};

// The 35 mm format compares diagonals (CIPA DCG-001).
KnownFocalLength focal_length(const RigFile& rig, const calibration::SensorPicture& picture) {
  const double millimetres = picture.focal_length_35mm;
  if (!(millimetres > 0)) return {rig.focal_length_guess_px, "the rig file's focal_length_guess_px"};
  return {millimetres / std::hypot(36.0, 24.0) * std::hypot(picture.mosaic.cols, picture.mosaic.rows),
          "EXIF, " + nlohmann::json(millimetres).dump() + " mm in 35 mm format"};
}

CalibrationFiles calibration_bytes(const RigCalibration& calibration) {
  const std::string text = to_json(calibration).dump(2) + "\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {{"calibration.json", {bytes, bytes + text.size()}}};
}

}  // namespace

Plan plan_of(const ImportFile& import, const std::vector<double>& exposures_s) {
  Plan plan;
  std::map<std::string, int> counted;
  for (const StepKind kind : {StepKind::pose, StepKind::view})
    for (std::size_t i = 0; i < import.pictures.size(); ++i) {
      const ImportedPicture& picture = import.pictures[i];
      if (picture.kind != kind) continue;
      PlanStep step{.id = id_of(picture, counted),
                    .kind = kind,
                    .mounting = picture.mounting,
                    .lamp = picture.lamp,
                    .room_light = kind == StepKind::pose,
                    .platform_angle_rad = picture.platform_angle_rad};
      step.exposure_s = exposures_s.at(i);
      plan.steps.push_back(step);
    }
  add_darks(plan, import, exposures_s);
  if (const auto problem = check_plan(plan, 2 * std::numbers::pi)) throw std::runtime_error(*problem);
  return plan;
}

RigCalibration calibration_by_tape(const RigFile& rig, const ImportFile& import,
                                   const calibration::SensorPicture& first, const std::string& utc) {
  RigCalibration result;
  result.rig_name = rig.name;
  result.utc = utc;
  result.software = software_version();
  result.camera = {.model = first.model,
                   .serial = first.serial,
                   .lens = rig.lens_name,
                   .focus = rig.focus,
                   .f_number = first.f_number};
  result.linear_srgb_from_camera = rig.linear_srgb_from_camera;
  std::string lens_from = "the lens file";
  if (!import.lens.empty()) {
    result.lens = parse_lens_file(read_json_file(import.lens), import.lens.string()).fit;
    if (result.lens.lens.width_px != first.mosaic.cols || result.lens.lens.height_px != first.mosaic.rows)
      throw std::runtime_error("the lens file '" + import.lens.string() + "' is for pictures of " +
                               std::to_string(result.lens.lens.width_px) + " x " +
                               std::to_string(result.lens.lens.height_px) + " pixels, these have " +
                               std::to_string(first.mosaic.cols) + " x " + std::to_string(first.mosaic.rows) +
                               "; give the lens of this camera");
  } else {
    const auto [f_px, from] = focal_length(rig, first);
    lens_from = from;
    result.lens.lens = {.width_px = first.mosaic.cols,
                        .height_px = first.mosaic.rows,
                        .fx_px = f_px,
                        .fy_px = f_px,
                        .cx_px = (first.mosaic.cols - 1) / 2.0,
                        .cy_px = (first.mosaic.rows - 1) / 2.0,
                        .distortion = {}};
    result.lens.lattice = {.columns = 2, .rows = 2, .spacing_mm = 1};
    result.lens.covariance = Eigen::MatrixXd::Identity(9, 9) * std::pow(kFocalLength * f_px, 2);
    result.lens.projection_sigma_px =
        Eigen::MatrixXd::Constant(calibration::kGridRows, calibration::kGridColumns, kFocalLength * f_px);
  }
  result.platform.world_from_camera = rig.world_from_camera_by_tape;
  result.platform.axis_covariance = Eigen::Vector4d(1e-4, 1e-4, kTape_mm * kTape_mm, kTape_mm * kTape_mm).asDiagonal();
  result.light.positions = {rig.front_lamp_mm, rig.back_lamp_mm};
  for (const Eigen::Vector3d& position : result.light.positions) {
    result.light.beam_axes.push_back((rig.lamp_aim_mm - position).normalized());
    result.light.position_covariances.emplace_back(Eigen::Matrix3d::Identity() * kTape_mm * kTape_mm);
    result.light.aim_irradiance_sigma.push_back(2 * kTape_mm / (position - rig.lamp_aim_mm).norm());
  }
  result.light.intensity = *import.lamp_intensity_mm2;
  result.light.gates = {{.name = "measured by tape",
                         .value = kTape_mm,
                         .limit = 0,
                         .passed = false,
                         .reason = "camera and lamps stand where a tape says, the focal length is by " + lens_from +
                                   "; calibrate the rig for figures to rely on"}};
  return result;
}

RunState import_session(const fs::path& list, const CaptureRequest& request) {
  const ImportFile import = read_import_file(list);
  const nlohmann::json rig_document = read_json_file(import.rig), spool_document = read_spool_document(import.spool);
  const RigFile rig = parse_rig(rig_document, import.rig.string());
  parse_spool(spool_document, import.spool.string());
  const std::vector<ListedPicture> listed = read_listed(import);
  HandTakenPictures pictures(listed);
  std::vector<double> exposures_s;
  for (const ListedPicture& picture : listed) exposures_s.push_back(picture.raw.exposure_s);
  rig::SystemClock clock;
  const Plan plan = plan_of(import, exposures_s);
  const RigCalibration calibration = import.calibration.empty()
                                         ? calibration_by_tape(rig, import, listed.front().raw, clock.utc())
                                         : read_calibration(import.calibration);
  FileSystem disk;
  SessionFolder session = SessionFolder::create(
      request.session, make_session_document(clock.utc(), rig_document, spool_document, plan, import.person),
      import.calibration.empty() ? calibration_bytes(calibration) : calibration_files(import.calibration, calibration),
      clock, disk);
  HandCamera camera(pictures);
  HandTurned turntable(pictures);
  HandArranged person(pictures);
  ProgressDisplay display("import", request.progress_style);
  RunOptions options;
  options.settings = {.exposure_s = 1, .iso = listed.front().raw.iso, .f_number = listed.front().raw.f_number};
  options.progress = [&](const Progress& p) {
    display.show(static_cast<int>(p.done), static_cast<int>(p.total), p.step);
  };
  options.judged = [&](const PlanStep& step, const Verdict& verdict) {
    if (verdict.grade() == Grade::doubtful) display.note(step.id + " is doubtful: " + verdict.reason());
  };
  const RunState state = run_session(
      session, {.camera = camera, .turntable = turntable, .person = person, .clock = clock, .taken_before = true},
      read_session_file(request.session), calibration, request, options);
  display.finish(state_name(state) + ": " + request.session.string());
  return state;
}

}  // namespace station
