#include "station/develop/develop_session.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "calibration/develop.h"
#include "calibration/lamp_stability.h"
#include "calibration/median.h"
#include "calibration/sensor_maps.h"
#include "renderer/image_file.h"
#include "station/bench_reading.h"
#include "station/calibration_validity.h"
#include "station/capture/manifest.h"
#include "station/capture/picture_record.h"
#include "station/capture/sha256.h"
#include "station/develop/mounted_holder.h"
#include "station/develop/sheet_width.h"
#include "station/documents/calibration_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/report/html.h"
#include "station/views.h"

namespace station {
namespace {

constexpr double kDegPerRad = 180.0 / M_PI;
constexpr int kMaskSamples = 8;
constexpr double kMostDarkOffset = 1e-3;  // of the range; a bias drifts by a DN or two

using Pictures = std::map<std::string, PictureRecord>;

const PictureRecord& picture_of(const Pictures& pictures, const std::string& step) {
  const auto found = pictures.find(step);
  if (found == pictures.end())
    throw std::runtime_error("the session has no picture of step " + step + "; finish it with capture --resume");
  return found->second;
}

calibration::SensorPicture read_picture(const std::filesystem::path& session, const PictureRecord& record) {
  const std::filesystem::path file = session / record.file;
  if (!std::filesystem::exists(file) || sha256_of_file(file) != record.sha256)
    throw std::runtime_error(file.string() +
                             " is missing or differs from the journal; take it again with capture --resume");
  return calibration::read_sensor_file(file);
}

// Where things stand in one view, holder frame. The platform's angle is the ring's where its tags can be read in the
// lamp's light, else the turntable's.
DevelopedView place_view(const PlanStep& step, const PictureRecord& picture, const BenchReading& bench,
                         const MountedHolder& mounted, const RigCalibration& calibration, double lamp_radius_mm) {
  DevelopedView developed;
  developed.angle_measured = bench.angle.has_value();
  developed.platform_angle_rad =
      bench.angle ? bench.angle->angle_rad : calibration.platform.scale * picture.read_angle_rad;
  const Eigen::Isometry3d world_from_holder =
      Eigen::AngleAxisd(developed.platform_angle_rad, Eigen::Vector3d::UnitZ()) * mounted.platform_from_holder;
  const Eigen::Isometry3d holder_from_world = world_from_holder.inverse();
  developed.mounting = step.mounting;
  developed.pose_rms_px = mounted.rms_px;
  developed.image_file = "linear/" + step.id + ".exr";
  developed.mask_file = "masks/" + step.id + ".png";
  inversion::View& view = developed.view;
  view.id = step.id;
  view.transmission = is_transmission(step);
  view.camera = camera_of(calibration.lens.lens, holder_from_world * calibration.platform.world_from_camera, true);
  view.light = lamp_in_holder(calibration, lamp_radius_mm, view.transmission, holder_from_world);
  return developed;
}

// The session's dark frame says how far the bias has drifted since the calibration; the maps say the rest, with the noise
// of many frames. Without a calibrated sensor it is the dark level itself.
calibration::DevelopOptions develop_options(const RigCalibration& calibration, const calibration::SensorPicture& dark,
                                            const std::string& view) {
  calibration::DevelopOptions options{.vignetting = calibration.light.vignetting, .lens = calibration.lens.lens};
  if (!calibration.sensor) {
    options.dark_dn = calibration::master_dark({dark});
    return options;
  }
  options.response = &calibration.sensor->response;
  options.dark_offset_dn = calibration::dark_offset_dn(dark, options.response->maps);
  const double range_dn = dark.white_level_dn - dark.black_level_dn;
  if (std::abs(options.dark_offset_dn) > kMostDarkOffset * range_dn)
    throw std::runtime_error(
        "the dark frame of view " + view + " is " + number_text(100 * options.dark_offset_dn / range_dn, 2) +
        " % of the range brighter than the calibration's; light fell on it: switch lamp and room "
        "light off, discard it and take it again with capture --resume");
  return options;
}

// The view's picture, then its further exposures; they are merged by measured times, so only with a calibrated sensor.
std::vector<calibration::SensorPicture> read_bracket(const std::filesystem::path& session, const Plan& plan,
                                                     const Pictures& pictures, const std::string& view,
                                                     const calibration::SensorPicture& metered,
                                                     const RigCalibration& calibration) {
  std::vector<calibration::SensorPicture> bracket{metered};
  if (!calibration.sensor) return bracket;
  for (const PlanStep& step : plan.steps)
    if (step.kind == StepKind::exposure && step.exposure_of == view)
      bracket.push_back(read_picture(session, picture_of(pictures, step.id)));
  return bracket;
}

// `patches`: readings of the views before this one, in the order of their pictures; this one's is added.
void read_lamp(const RigFile& rig, const inversion::WrappedSpool& spool, const calibration::Developed& picture,
               double time_s, const Eigen::Vector2d& droop, const DevelopedView& developed,
               std::vector<PatchView>& patches) {
  if (!rig.reference_patch) return;
  const inversion::View& view = developed.view;
  patches.push_back({.behind = view.transmission,
                     .time_s = time_s,
                     .reading = read_patch(picture.radiance, picture.saturated, view.camera, *rig.reference_patch,
                                           spool, developed.mounting, view.light, droop)});
}

// Divides every view by the lamp's strength in it.
void take_out_lamp_changes(const std::vector<PatchView>& patches, std::vector<DevelopedView>& views) {
  const std::vector<double> strengths = lamp_strengths(patches);
  const calibration::Gate change = calibration::lamp_gates(strengths).back();
  if (!change.passed) throw std::runtime_error("the session's views do not belong together: " + change.reason);
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i].lamp_strength = strengths.at(i);
    views[i].view.image /= strengths.at(i);
  }
}

void write_view(const std::filesystem::path& session, const DevelopedView& developed) {
  renderer::write_exr(
      session / developed.image_file, developed.view.image,
      {{"threadstation/content",
        "linear camera RGB, radiance unit (full scale per second); dark subtracted, "
        "exposures merged and divided by their times and the lamp's strength, flat-fielded, distortion "
        "removed"},
       {"threadstation/view", developed.view.id}});
  renderer::write_png(session / developed.mask_file, developed.view.mask);
}

// Everything but writing it and the lamp's strength, which all views say together.
void develop_view(const std::filesystem::path& session, const SessionFile& asked, const Pictures& pictures,
                  const calibration::SensorPicture& raw, const RigCalibration& calibration,
                  std::vector<PatchView>& patches, DevelopedView& developed) {
  inversion::View& view = developed.view;
  const inversion::WrappedSpool& spool = asked.spool.wrapping;
  const auto bracket = read_bracket(session, asked.plan, pictures, view.id, raw, calibration);
  const calibration::SensorPicture dark = read_picture(session, picture_of(pictures, "dark-" + view.id));
  const calibration::Developed picture = calibration::develop(bracket, develop_options(calibration, dark, view.id));
  developed.exposure_s = bracket.front().exposure_s;
  const double time_s = 86400 * days_between(asked.utc, picture_of(pictures, view.id).utc);
  read_lamp(asked.rig, spool, picture, time_s, calibration.light.droop, developed, patches);
  view.image = picture.radiance;
  view.mask = inversion::thread_mask(spool, view.camera, view.light, kMaskSamples);
  developed.masked_pixels = cv::countNonZero(view.mask);
  if (developed.masked_pixels == 0)
    throw std::runtime_error("view " + view.id +
                             ": no thread is where the calibration expects them; calibrate the rig again");
  developed.saturated_fraction =
      static_cast<double>(cv::countNonZero(picture.saturated & view.mask)) / developed.masked_pixels;
}

// Median over the reflections that show both edges.
std::optional<double> measured_width_mm(const DevelopedViews& developed, const inversion::WrappedSpool& spool) {
  std::vector<double> widths;
  for (const DevelopedView& view : developed.views) {
    if (view.view.transmission) continue;
    if (const auto width = sheet_width_mm(view.view.image, view.view.camera, spool)) widths.push_back(*width);
  }
  if (widths.empty()) return std::nullopt;
  return calibration::median(widths);
}

void require_expected_width(double width_mm, const Spool& spool) {
  constexpr double kTolerance = 0.05;  // a pixel or two at either edge; a forgotten turn is 0.02
  const double expected_mm = spool.wrapping.turns * spool.wrapping.thread_diameter_mm;
  if (std::abs(width_mm - expected_mm) <= kTolerance * expected_mm) return;
  throw std::runtime_error("spool \"" + spool.name + "\": " + std::to_string(spool.wrapping.turns) + " turns of " +
                           number_text(spool.wrapping.thread_diameter_mm, 3) + " mm would be " +
                           number_text(expected_mm, 2) + " mm wide, the pictures show " + number_text(width_mm, 2) +
                           " mm; correct turns or thread_diameter_mm in the spool file");
}

}  // namespace

DevelopedViews develop_session(const std::filesystem::path& session, ProgressStyle progress_style) {
  const SessionFile asked = read_session_file(session);
  RigCalibration calibration = read_calibration(session / "calibration");
  if (calibration.sensor) load_sensor_maps(session / "calibration", *calibration.sensor);
  const Pictures pictures = taken_pictures(read_journal(session / "journal.jsonl").records);
  std::map<rig::Mounting, MountedHolder> mounted;
  std::map<rig::Mounting, std::vector<PosePicture>> posed;
  for (const PlanStep& step : asked.plan.steps) {
    if (step.kind != StepKind::pose) continue;
    const PictureRecord& picture = picture_of(pictures, step.id);
    posed[step.mounting].push_back({step.id, picture.read_angle_rad, tags_in(read_picture(session, picture))});
  }
  for (const auto& [mounting, seen] : posed) mounted[mounting] = measure_holder(seen, calibration, asked.rig);

  ProgressDisplay progress("develop", progress_style);
  DevelopedViews developed;
  developed.linear_srgb_from_camera = calibration.linear_srgb_from_camera;
  std::vector<PatchView> patches;
  const auto total = static_cast<int>(view_count(asked.plan));
  for (const PlanStep& step : asked.plan.steps) {
    if (step.kind != StepKind::view) continue;
    progress.show(static_cast<int>(developed.views.size()), total, step.id);
    const PictureRecord& record = picture_of(pictures, step.id);
    const calibration::SensorPicture raw = read_picture(session, record);
    const BenchReading bench = read_bench(calibration, asked.rig, tags_in(raw));
    require_calibrated_bench(calibration, bench, record.read_angle_rad, "view " + step.id);
    developed.views.push_back(
        place_view(step, record, bench, mounted.at(step.mounting), calibration, asked.rig.lamp_radius_mm));
    develop_view(session, asked, pictures, raw, calibration, patches, developed.views.back());
  }
  if (!patches.empty()) take_out_lamp_changes(patches, developed.views);
  for (const DevelopedView& view : developed.views) write_view(session, view);
  developed.sheet_width_mm = measured_width_mm(developed, asked.spool.wrapping);
  if (developed.sheet_width_mm) require_expected_width(*developed.sheet_width_mm, asked.spool);
  write_json_file(session / "linear" / "views.json", to_json(developed));
  FileSystem disk;
  write_manifest(session / "linear", disk);
  write_manifest(session / "masks", disk);
  progress.finish(std::to_string(total) + " views");
  return developed;
}

std::string describe(const DevelopedViews& developed) {
  std::string text;
  for (const DevelopedView& view : developed.views)
    text += view.view.id + ": " + number_text(view.platform_angle_rad * kDegPerRad, 2) +
            (view.angle_measured ? " deg (tags), exposure " : " deg (turntable), exposure ") +
            number_text(view.exposure_s, 4) + " s, " + std::to_string(view.masked_pixels) +
            " masked pixels, saturated " + number_text(100 * view.saturated_fraction, 2) + " %, holder tags " +
            number_text(view.pose_rms_px, 3) + " px, lamp " + number_text(100 * view.lamp_strength, 2) + " %\n";
  if (developed.sheet_width_mm)
    text += "sheet of threads: " + number_text(*developed.sheet_width_mm, 2) + " mm wide\n";
  return text;
}

}  // namespace station
