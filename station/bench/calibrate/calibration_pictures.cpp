#include "station/bench/calibrate/calibration_pictures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "calibration/sensor/sensor_file.h"
#include "station/bench/calibrate/standing_target.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/exposure.h"
#include "station/documents/degree.h"
#include "station/documents/disk/file_system.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/reader.h"

namespace station {
namespace {

constexpr int kMaxTestPictures = 6;

void write_list(const std::filesystem::path& folder, const std::vector<CalibrationPicture>& pictures) {
  nlohmann::json list = nlohmann::json::array();
  for (const CalibrationPicture& p : pictures) {
    list.push_back({{"id", p.id},
                    {"role", to_text(p.role)},
                    {"file", p.file},
                    {"sha256", p.sha256},
                    {"reading_deg", p.reading_rad / kDegree},
                    {"exposure_s", p.exposure_s},
                    {"exposure_of", p.exposure_of},
                    {"utc", p.utc}});
    if (p.lamp_output) list.back()["lamp_output"] = *p.lamp_output;
  }
  write_json_file(folder / "pictures.json",
                  {{"format", "threadstation/calibration_pictures"}, {"version", 1}, {"pictures", list}});
}

std::vector<CalibrationPicture> read_list(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "pictures.json";
  const nlohmann::json document = read_json_file(file);
  ObjectReader reader(document, file.string(), "calibration_pictures");
  std::vector<CalibrationPicture> pictures;
  for (ObjectReader& entry : reader.objects("pictures")) {
    CalibrationPicture p;
    p.id = entry.text("id");
    p.role = calibration_role(entry.text("role"));
    p.file = entry.text("file");
    p.sha256 = entry.text("sha256");
    p.reading_rad = entry.number("reading_deg", -360, 360) * kDegree;
    p.exposure_s = entry.number("exposure_s", 1e-9, 1e6);
    p.exposure_of = entry.text("exposure_of");
    p.utc = entry.text("utc");
    if (entry.has("lamp_output")) p.lamp_output = entry.number("lamp_output", 0.01, 100);
    entry.finish();
    pictures.push_back(p);
  }
  reader.finish();
  return pictures;
}

bool intact(const std::filesystem::path& folder, const CalibrationPicture& picture) {
  const std::filesystem::path file = folder / picture.file;
  return std::filesystem::is_regular_file(file) && sha256_of_file(file) == picture.sha256;
}

// The sensor's pictures are closer to the white level: the ladder goes on from there.
ExposureAim aim_of(CalibrationRole role) {
  const bool sensor = role == CalibrationRole::response || role == CalibrationRole::white_field;
  return sensor ? ExposureAim{.level = 0.7, .tolerance = 1.25} : ExposureAim{};
}

// Meters with test pictures, then takes the one to keep.
rig::Picture well_exposed_picture(rig::Camera& camera, const ExposureAim& aim, double& exposure_s) {
  const std::vector<double> offered = camera.shutter_times_s();
  for (int attempt = 0; attempt < kMaxTestPictures; ++attempt) {
    exposure_s = camera.configure({.exposure_s = rig::nearest_shutter_s(offered, exposure_s)}).exposure_s;
    rig::Picture picture = camera.capture();
    const auto wanted = next_exposure_s(calibration::read_sensor_bytes(picture.bytes, "test picture"), {}, aim);
    if (!wanted || rig::nearest_shutter_s(offered, *wanted) == exposure_s) return picture;
    exposure_s = *wanted;
  }
  throw std::runtime_error("no exposure suits the calibration picture after " + std::to_string(kMaxTestPictures) +
                           " tries; check the light and that nothing shines into the lens");
}

// The same exposure as another picture's, so many stops longer.
rig::Picture picture_like(rig::Camera& camera, const std::vector<CalibrationPicture>& pictures,
                          const CalibrationStep& step) {
  const auto like = std::find_if(pictures.begin(), pictures.end(),
                                 [&](const CalibrationPicture& p) { return p.id == step.exposure_of; });
  if (like == pictures.end())
    throw std::runtime_error("step " + step.id + " repeats the exposure of " + step.exposure_of +
                             ", which is missing; take it again with calibrate");
  const double wanted_s = like->exposure_s * std::exp2(step.stops);
  const double exposure_s = rig::nearest_shutter_s(camera.shutter_times_s(), wanted_s);
  if (std::abs(std::log2(exposure_s / wanted_s)) > 0.2)
    throw std::runtime_error("step " + step.id + " needs an exposure of " + std::to_string(wanted_s) +
                             " s, the camera's nearest is " + std::to_string(exposure_s) +
                             " s; move the lamp so that the panel is well exposed near 1/8 s");
  camera.configure({.exposure_s = exposure_s});
  return camera.capture();
}

constexpr int kCorrections = 3;

// The angles for the steps of the plan from `first` on that share its place and role. `standing`: where the target was
// seen to stand, if it was; otherwise it is looked for, and a person is asked to put it right where it cannot be seen
// as planned.
std::vector<double> angles_of(const RigFile& rig, const std::vector<CalibrationStep>& plan, std::size_t first,
                              RigDevices& devices, std::optional<Eigen::Isometry3d>& standing, double& exposure_s) {
  const CalibrationStep& step = plan[first];
  std::vector<double> planned;
  for (const CalibrationStep& other : plan)
    if (share_a_mounting(step, other)) planned.push_back(other.platform_angle_rad);
  const std::size_t n = planned.size();
  for (int asked = 0;; ++asked) {
    for (const std::size_t look : {n / 2, n / 4, n * 3 / 4}) {
      if (standing) break;
      devices.turntable->move_to(planned[look]);
      const rig::Picture picture = well_exposed_picture(*devices.camera, aim_of(CalibrationRole::lens), exposure_s);
      const calibration::SensorPicture raw = calibration::read_sensor_bytes(picture.bytes, "picture for " + step.id);
      standing = find_target(rig, step.arrangement, tags_in(raw), raw.mosaic.size(), devices.turntable->angle_rad());
    }
    if (standing)
      if (const auto angles = angles_for(rig, plan, first, *standing)) return *angles;
    const std::string wrong = how_to_stand(step.arrangement, standing);
    if (asked == kCorrections) throw std::runtime_error(wrong + " The same command goes on from here.");
    devices.person->correct(wrong);
    standing.reset();
  }
}

// Takes the mounting that begins with plan[first] off the plan, and those after it, as long as no picture of it is
// there and the pictures so far do without.
void drop_unneeded(std::vector<CalibrationStep>& plan, std::size_t first,
                   const std::function<bool(const std::string&)>& known, LensCoverage& covered) {
  while (first > 0 && first < plan.size() && plan[first].if_needed && !share_a_mounting(plan[first - 1], plan[first])) {
    const auto begin = plan.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end =
        std::find_if(begin, plan.end(), [&](const CalibrationStep& step) { return !share_a_mounting(*begin, step); });
    if (std::any_of(begin, end, [&](const CalibrationStep& step) { return known(step.id); })) return;
    if (!covered.lens_is_known()) return;
    plan.erase(begin, end);
  }
}

}  // namespace

std::vector<CalibrationPicture> record_calibration(const RigFile& rig, std::vector<CalibrationStep>& plan,
                                                   RigDevices& devices, const std::filesystem::path& folder,
                                                   const StepProgress& progress,
                                                   const std::function<bool()>& should_stop, LensCoverage& covered) {
  std::error_code code;
  std::filesystem::create_directories(folder / "pictures", code);
  if (code)
    throw std::runtime_error("cannot make " + (folder / "pictures").string() + ": " + code.message() +
                             "; choose a writable folder");
  std::vector<CalibrationPicture> pictures;
  if (std::filesystem::exists(folder / "pictures.json")) pictures = read_list(folder);
  std::erase_if(pictures, [&](const CalibrationPicture& p) { return !intact(folder, p); });
  const auto known = [&](const std::string& id) {
    return std::any_of(pictures.begin(), pictures.end(), [&](const CalibrationPicture& p) { return p.id == id; });
  };

  const auto cover = [&](const calibration::SensorPicture& raw) { covered.add(tags_in(raw), raw.mosaic.size()); };
  const bool board_comes = std::ranges::any_of(
      plan, [&](const CalibrationStep& step) { return step.role == CalibrationRole::lens && !known(step.id); });
  for (const CalibrationPicture& p : pictures)
    if (board_comes && p.role == CalibrationRole::lens) cover(calibration::read_sensor_file(folder / p.file));

  FileSystem disk;
  devices.turntable->home();
  double exposure_s = 0.125;
  std::optional<Eigen::Isometry3d> standing;  // of what is on a stand
  std::optional<rig::Arrangement> arranged;   // how the bench stands, as far as a person was asked
  std::vector<double> angles;                 // of the steps that share a place and a role
  std::size_t begin = 0;                      // the first of them
  for (std::size_t i = 0; i < plan.size(); ++i) {
    drop_unneeded(plan, i, known, covered);
    if (i == plan.size()) break;
    const CalibrationStep& step = plan[i];
    if (!rig::same_arrangement(step.arrangement, plan[begin].arrangement)) standing.reset();
    if (!share_a_mounting(step, plan[begin])) {
      begin = i;
      angles.clear();
    }
    progress(static_cast<int>(i), static_cast<int>(plan.size()), step.id);
    if (known(step.id)) continue;
    if (should_stop()) {
      devices.turntable->stop();
      throw std::runtime_error("calibration interrupted; the same command goes on from here");
    }
    const bool put_down =
        step.arrangement.stand > 0 && !(arranged && rig::same_arrangement(*arranged, step.arrangement));
    if (put_down) devices.turntable->move_to(0);  // "its face towards the camera" is the platform's front then
    devices.person->arrange(step.arrangement);
    arranged = step.arrangement;
    if (step.follows_target && angles.empty()) angles = angles_of(rig, plan, begin, devices, standing, exposure_s);
    devices.turntable->move_to(step.follows_target ? angles.at(i - begin) : step.platform_angle_rad);
    const rig::Picture picture = step.exposure_of.empty()
                                     ? well_exposed_picture(*devices.camera, aim_of(step.role), exposure_s)
                                     : picture_like(*devices.camera, pictures, step);
    CalibrationPicture entry{.id = step.id,
                             .role = step.role,
                             .file = "pictures/" + step.id + "." + picture.extension,
                             .sha256 = {},
                             .exposure_of = {},
                             .utc = {}};
    entry.reading_rad = devices.turntable->angle_rad();
    entry.exposure_s = picture.settings.exposure_s;
    entry.exposure_of = step.exposure_of;
    entry.utc = picture.utc;
    entry.sha256 = store_file(disk, folder / entry.file, picture.bytes);
    pictures.push_back(entry);
    write_list(folder, pictures);
    if (step.role == CalibrationRole::lens) cover(calibration::read_sensor_bytes(picture.bytes, entry.file));
  }
  progress(static_cast<int>(plan.size()), static_cast<int>(plan.size()), "done");
  return pictures;
}

void forget_calibration_pictures(const std::filesystem::path& folder,
                                 const std::function<bool(CalibrationRole)>& forget) {
  if (!std::filesystem::exists(folder / "pictures.json")) return;
  std::vector<CalibrationPicture> pictures = read_list(folder);
  std::erase_if(pictures, [&](const CalibrationPicture& p) { return forget(p.role); });
  write_list(folder, pictures);
}

std::string oldest_part_utc(const std::vector<CalibrationPicture>& pictures) {
  std::map<std::string, std::string> last;
  for (const CalibrationPicture& picture : pictures) {
    std::string& utc = last[part_of(picture.role)];
    utc = std::max(utc, picture.utc);
  }
  std::string oldest;
  for (const auto& [part, utc] : last)
    if (oldest.empty() || utc < oldest) oldest = utc;
  return oldest;
}

std::vector<CalibrationPicture> read_calibration_pictures(const std::filesystem::path& folder) {
  std::vector<CalibrationPicture> pictures = read_list(folder);
  for (const CalibrationPicture& p : pictures)
    if (!intact(folder, p))
      throw std::runtime_error("calibration picture " + (folder / p.file).string() +
                               " is missing or differs from its recorded hash; take it again with calibrate");
  return pictures;
}

}  // namespace station
