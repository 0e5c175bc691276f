#include "station/session/develop/develop_session.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calibration/develop/develop.h"
#include "calibration/light/lamp_stability.h"
#include "calibration/sensor/median.h"
#include "calibration/sensor/sensor_maps.h"
#include "renderer/picture/image_file.h"
#include "station/bench/bench_reading.h"
#include "station/bench/calibration_validity.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/bench/mounted_holder.h"
#include "station/bench/reference_chip.h"
#include "station/documents/calibration_file.h"
#include "station/documents/degree.h"
#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/manifest.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/output/display.h"
#include "station/session/checks/capture_checks.h"
#include "station/session/develop/develop_measured.h"
#include "station/session/develop/sheet_width.h"
#include "station/session/develop/view_files.h"
#include "station/session/record/bracket.h"
#include "station/session/record/picture_record.h"

namespace station {
namespace {
constexpr const char* kDeveloped =
    "linear camera RGB, radiance unit (full scale per second); dark subtracted, exposures merged and divided by their "
    "times, flat-fielded, distortion removed; to be divided by the view's lamp_strength in views.json";
constexpr double kBytesPerPixel = 75;  // of a view while it is developed: its planes counted, not measured

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

// The places of holder, camera and lamp in one view, in the holder's frame. The platform's angle is the ring's where
// its tags can be read in the lamp's light, else the turntable's.
DevelopedView place_view(const PlanStep& step, const PictureRecord& picture, const BenchReading& bench,
                         const MountedHolder& mounted, const RigCalibration& calibration, const RigFile& rig) {
  DevelopedView developed;
  developed.angle_measured = bench.angle.has_value();
  developed.platform_angle_rad =
      bench.angle ? bench.angle->angle_rad : calibration.platform.scale * picture.read_angle_rad;
  const Eigen::Isometry3d world_from_holder =
      Eigen::AngleAxisd(developed.platform_angle_rad, Eigen::Vector3d::UnitZ()) * mounted.platform_from_holder;
  const Eigen::Isometry3d holder_from_world = world_from_holder.inverse();
  developed.mounting = step.mounting;
  developed.pose_rms_px = mounted.rms_px;
  developed.image_file = image_file_of(step.id);
  developed.mask_file = mask_file_of(step.id);
  inversion::View& view = developed.view;
  view.id = step.id;
  view.transmission = is_transmission(step);
  view.camera = camera_of(calibration.lens.lens, holder_from_world * calibration.platform.world_from_camera, true);
  view.light = lamp_in_holder(calibration, rig, step.lamp, holder_from_world);
  return developed;
}

// The options of development: dark level, response and lens. With a calibrated sensor the session's dark frame tells
// how far the bias has drifted since the calibration, and the maps, with the low noise of many frames, tell the rest.
// Without a calibrated sensor the dark frame is the dark level itself; without a dark frame (pictures taken by hand)
// the file's black level is used.
calibration::DevelopOptions develop_options(const RigCalibration& calibration,
                                            const std::optional<calibration::SensorPicture>& taken_dark,
                                            const std::string& view) {
  calibration::DevelopOptions options{.vignetting = calibration.light.vignetting, .lens = calibration.lens.lens};
  if (calibration.sensor) options.response = &calibration.sensor->response;
  if (!taken_dark) return options;
  const calibration::SensorPicture& dark = *taken_dark;
  if (!calibration.sensor) {
    options.dark_dn = calibration::master_dark({dark});
    return options;
  }
  options.dark_offset_dn = calibration::dark_offset_dn(dark, options.response->maps);
  const double range_dn = dark.white_level_dn - dark.black_level_dn;
  if (std::abs(options.dark_offset_dn) > calibration::kMostDarkOffset * range_dn)
    throw std::runtime_error("the dark frame of view " + view + " is " +
                             number_text(100 * options.dark_offset_dn / range_dn, 2) +
                             " % of the range brighter than the calibration's; light fell on it: switch lamp and room "
                             "light off, discard it and take it again with capture --resume");
  return options;
}

// The view's picture, then its further exposures. They are merged by measured exposure times, so without a calibrated
// sensor there are none.
std::vector<calibration::SensorPicture> read_bracket(const std::filesystem::path& session, const Plan& plan,
                                                     const Pictures& pictures, const std::string& view,
                                                     const calibration::SensorPicture& metered,
                                                     const RigCalibration& calibration) {
  std::vector<calibration::SensorPicture> bracket{metered};
  if (!calibration.sensor) return bracket;
  for (const PlanStep& step : plan.steps)
    if (step.kind == StepKind::bracket && step.exposure_of == view && is_needed(step, pictures))
      bracket.push_back(read_picture(session, picture_of(pictures, step.id)));
  return bracket;
}

ChipView read_lamp(const RigFile& rig, const inversion::WrappedSpool& spool, const calibration::Developed& picture,
                   double time_s, const Eigen::Vector2d& droop, const DevelopedView& developed) {
  const inversion::View& view = developed.view;
  ChipView chip{.behind = view.transmission, .time_s = time_s, .reading = std::nullopt};
  if (rig.reference_chip)
    chip.reading = read_chip(picture.radiance, picture.saturated, view.camera, *rig.reference_chip, spool,
                             developed.mounting, view.light, droop);
  return chip;
}

// Notes each view's lamp strength. The pictures themselves stay as they are: read_view_pictures divides them.
void note_lamp_changes(const std::vector<ChipView>& chips, std::vector<DevelopedView>& views) {
  const std::vector<double> strengths = lamp_strengths(chips);
  const calibration::Gate change = calibration::lamp_gates(strengths).back();
  if (!change.passed) throw std::runtime_error("the session's views do not belong together: " + change.reason);
  for (std::size_t i = 0; i < views.size(); ++i) views[i].lamp_strength = strengths.at(i);
}

// How far the threads may be from where the calibration puts them, in pixels: two standard errors.
int edge_px(const RigCalibration& calibration, const MountedHolder& mounted) {
  double lens_px = 0;
  if (const Eigen::MatrixXd& sigma = calibration.lens.projection_sigma_px; sigma.size() > 0)
    lens_px = sigma(sigma.rows() / 2, sigma.cols() / 2);
  constexpr double kMost_px = 50;  // a tape's error would leave no threads at all
  return static_cast<int>(std::lround(std::min(kMost_px, 2 * std::hypot(lens_px, mounted.rms_px))));
}

cv::Mat1b eroded(const cv::Mat1b& mask, int edge) {
  if (edge < 1) return mask;
  cv::Mat1b smaller;
  cv::erode(mask, smaller, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * edge + 1, 2 * edge + 1}), {-1, -1}, 1,
            cv::BORDER_CONSTANT, cv::Scalar(0));
  return smaller;
}

struct DevelopedPicture {
  ChipView chip;
  std::optional<double> sheet_width_mm;  // reflections only
};

// Develops one view, except for the lamp's strength, which follows from all views together. Afterwards its picture is
// on the disk and no longer in memory.
DevelopedPicture develop_view(const std::filesystem::path& session, const SessionFile& asked, const Pictures& pictures,
                              const PlanStep& step, const RigCalibration& calibration, const MountedHolder& mounted,
                              DevelopedView& developed) {
  const PictureRecord& record = picture_of(pictures, step.id);
  const inversion::WrappedSpool& spool = asked.spool.wrapping;
  calibration::Developed picture;
  {
    const calibration::SensorPicture raw = read_picture(session, record);
    const BenchReading bench = read_bench(calibration, asked.rig, tags_in(raw));
    require_calibrated_bench(calibration, bench, record.read_angle_rad, "view " + step.id);
    developed = place_view(step, record, bench, mounted, calibration, asked.rig);
    developed.exposure_s = raw.exposure_s;
    const auto bracket = read_bracket(session, asked.plan, pictures, step.id, raw, calibration);
    std::optional<calibration::SensorPicture> dark;
    for (const PlanStep& other : asked.plan.steps)
      if (other.kind == StepKind::dark && other.exposure_of == step.id)
        dark = read_picture(session, picture_of(pictures, other.id));
    picture = calibration::develop(bracket, develop_options(calibration, dark, step.id));
  }
  DevelopedPicture result;
  if (!asked.spool.fabric)
    result.chip = read_lamp(asked.rig, spool, picture, 86400 * days_between(asked.utc, record.utc),
                            calibration.light.droop, developed);
  inversion::View& view = developed.view;
  view.image = picture.radiance;
  view.mask = eroded(asked.spool.fabric ? lit_side(asked.spool.fabric->cylinder, view.camera, view.light.position)
                                        : inversion::thread_mask(spool, view.camera, view.light, kMaskSamples),
                     edge_px(calibration, mounted));
  developed.masked_pixels = cv::countNonZero(view.mask);
  if (developed.masked_pixels == 0)
    throw std::runtime_error("view " + view.id +
                             ": no thread is where the calibration expects them; calibrate the rig again");
  developed.noise = inversion::noise_law(picture.radiance, picture.variance, view.mask);
  picture.variance.release();
  developed.saturated_fraction =
      static_cast<double>(cv::countNonZero(picture.saturated & view.mask)) / developed.masked_pixels;
  if (!view.transmission && !asked.spool.fabric) result.sheet_width_mm = sheet_width_mm(view.image, view.camera, spool);
  write_view(session, developed, kDeveloped, calibration.linear_srgb_from_camera);
  view.image.release();
  view.mask.release();
  return result;
}

// Does the work of all views, as many at once as processors and memory allow. Views are begun in order, none after an
// error; throws the first error in the views' order.
void for_each_view(std::size_t count, double bytes_per_view, const std::function<void(std::size_t)>& work) {
  constexpr double kMost_bytes = 3.0 * (1 << 30);
  const auto by_memory = static_cast<std::size_t>(std::max(1.0, kMost_bytes / bytes_per_view));
  std::atomic<bool> failed = false;
  std::vector<std::exception_ptr> errors(count);
  std::size_t next = 0;
  const auto begin = [&](tbb::flow_control& flow) {
    if (failed || next == count) flow.stop();
    return next++;
  };
  const auto develop = [&](std::size_t view) {
    try {
      tbb::this_task_arena::isolate([&] { work(view); });  // takes up no other view while it waits within this one
    } catch (...) {
      errors[view] = std::current_exception();
      failed = true;
    }
  };
  // Unlike parallel_for, a pipeline begins the views in order and holds no more of them at a time than it is told.
  tbb::parallel_pipeline(by_memory, tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, begin) &
                                        tbb::make_filter<std::size_t, void>(tbb::filter_mode::parallel, develop));
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

// The holder's place in each mounting by the session's pose pictures; without any of them it is the nominal one.
std::map<rig::Mounting, MountedHolder> mounted_holders(const std::filesystem::path& session, const SessionFile& asked,
                                                       const Pictures& pictures, const RigCalibration& calibration) {
  std::map<rig::Mounting, MountedHolder> mounted;
  std::map<rig::Mounting, std::vector<PosePicture>> posed;
  for (const PlanStep& step : asked.plan.steps) {
    if (step.kind != StepKind::pose) continue;
    const PictureRecord& picture = picture_of(pictures, step.id);
    posed[step.mounting].push_back({step.id, picture.read_angle_rad, tags_in(read_picture(session, picture))});
  }
  for (const auto& [mounting, seen] : posed) mounted[mounting] = measure_holder(seen, calibration, asked.rig);
  if (posed.empty())
    for (const rig::Mounting mounting : {rig::Mounting::horizontal, rig::Mounting::vertical})
      mounted[mounting] = {.platform_from_holder = nominal_pose(asked.rig, asked.spool, mounting)};
  return mounted;
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

// Notes what follows from all views together: the lamp's changes and the sheet's width.
void note_what_views_share(const SessionFile& asked, const std::vector<DevelopedPicture>& found,
                           DevelopedViews& developed) {
  std::vector<ChipView> chips;
  std::vector<double> widths_mm;
  for (const DevelopedPicture& picture : found) {
    chips.push_back(picture.chip);
    if (picture.sheet_width_mm) widths_mm.push_back(*picture.sheet_width_mm);
  }
  if (asked.rig.reference_chip && !asked.spool.fabric) note_lamp_changes(chips, developed.views);
  if (!widths_mm.empty()) developed.sheet_width_mm = calibration::median(widths_mm);
  if (developed.sheet_width_mm) require_expected_width(*developed.sheet_width_mm, asked.spool);
}

DevelopedViews develop_captured(const std::filesystem::path& session, const SessionFile& asked,
                                ProgressStyle progress_style) {
  RigCalibration calibration = read_calibration(session / "calibration");
  fill_in_sensor_maps(session / "calibration", calibration);
  const Pictures pictures = taken_pictures(read_journal(session / "journal.jsonl").records);
  const std::map<rig::Mounting, MountedHolder> mounted = mounted_holders(session, asked, pictures, calibration);
  std::vector<PlanStep> views;
  for (const PlanStep& step : asked.plan.steps)
    if (step.kind == StepKind::view) views.push_back(step);
  ProgressDisplay progress("develop", progress_style);
  DevelopedViews developed;
  developed.linear_srgb_from_camera = calibration.linear_srgb_from_camera;
  developed.views.resize(views.size());
  std::vector<DevelopedPicture> found(views.size());
  std::atomic<int> done = 0;
  const double pixels = static_cast<double>(calibration.lens.lens.width_px) * calibration.lens.lens.height_px;
  for_each_view(views.size(), kBytesPerPixel * pixels, [&](std::size_t i) {
    progress.show(done, static_cast<int>(views.size()), views[i].id);
    found[i] = develop_view(session, asked, pictures, views[i], calibration, mounted.at(views[i].mounting),
                            developed.views[i]);
    ++done;
  });
  note_what_views_share(asked, found, developed);
  progress.finish(std::to_string(views.size()) + " views");
  return developed;
}

}  // namespace

DevelopedViews develop_session(const std::filesystem::path& session, ProgressStyle progress_style) {
  const SessionFile asked = read_session_file(session);
  FileSystem disk;
  const OpenFile lock = lock_folder(session, disk);  // nobody captures into it meanwhile
  make_folder(session / "linear");
  make_folder(session / "masks");
  const DevelopedViews developed = asked.measured ? develop_measured(session, asked, progress_style)
                                                  : develop_captured(session, asked, progress_style);
  write_json_file(session / "linear" / "views.json", to_json(developed));
  write_manifest(session / "linear", disk);
  write_manifest(session / "masks", disk);
  return developed;
}

std::string describe(const DevelopedViews& developed) {
  std::string text;
  for (const DevelopedView& view : developed.views)
    text += view.view.id + ": " + number_text(view.platform_angle_rad / kDegree, 2) +
            (view.angle_measured ? " deg (tags), exposure " : " deg (turntable), exposure ") +
            number_text(view.exposure_s, 4) + " s, " + std::to_string(view.masked_pixels) +
            " masked pixels, saturated " + number_text(100 * view.saturated_fraction, 2) + " %, holder tags " +
            number_text(view.pose_rms_px, 3) + " px, lamp " + number_text(100 * view.lamp_strength, 2) + " %\n";
  if (developed.sheet_width_mm) text += "sheet of threads: " + number_text(*developed.sheet_width_mm, 2) + " mm wide\n";
  return text;
}

}  // namespace station
