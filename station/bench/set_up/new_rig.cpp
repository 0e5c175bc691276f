#include "station/bench/set_up/new_rig.h"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "calibration/develop/linear_grey.h"
#include "calibration/geometry/bench_sketch.h"
#include "station/bench/calibrate/standing_target.h"
#include "station/bench/drawing_operator.h"
#include "station/bench/guarded_turntable.h"
#include "station/bench/rig_devices.h"
#include "station/bench/room_picture.h"
#include "station/bench/set_up/rig_interview.h"
#include "station/data/data_folder.h"
#include "station/documents/commented_json.h"
#include "station/documents/degree.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

namespace fs = std::filesystem;

constexpr double kFNumber = 8;
constexpr double kReadingsDeg[] = {0, 10, 45, 90, 135}, kReadingsByHandDeg[] = {0, 30, 90};
constexpr double kScaleOff = 0.02;  // more than what the calibration is meant to correct
constexpr double kMostRollDeg = 5, kMostMarkDeg = 5, kMostBeside_mm = 20;

std::string degrees(double angle_rad) {
  return number_text(angle_rad / kDegree, 1) + " degrees";
}

RigFile parsed(const RigDraft& draft, const fs::path& name) {
  return parse_rig(nlohmann::json::parse(draft.dump()), name.string());
}

RigDraft draft_from(const fs::path& file) {
  return RigDraft::parse(text_of_file(file), nullptr, true, true);
}

// A picture of the empty platform at each reading.
std::vector<calibration::RingSighting> look(const RigFile& rig, const RigDevices& devices, cv::Size& size,
                                            ProgressDisplay& progress) {
  std::vector<double> readings(std::begin(kReadingsDeg), std::end(kReadingsDeg));
  if (rig.turntable_driver == "manual") readings.assign(std::begin(kReadingsByHandDeg), std::end(kReadingsByHandDeg));
  std::vector<calibration::RingSighting> sightings;
  const auto count = static_cast<int>(readings.size());
  for (const double reading_deg : readings) {
    if (interrupted()) throw Interrupted("looking at the platform was stopped; what was answered is kept");
    if (reading_deg * kDegree > platform_limit_rad(rig)) continue;
    progress.show(static_cast<int>(sightings.size()), count, "picture at " + number_text(reading_deg, 0) + " degrees");
    devices.turntable->move_to(reading_deg * kDegree);
    const RoomPicture room = take_room_picture(*devices.camera, rig.target_level, kFNumber);
    const cv::Mat1f grey = calibration::linear_grey(room.picture);
    size = grey.size();
    sightings.push_back({devices.turntable->angle_rad(), calibration::detect_tags(grey)});
  }
  return sightings;
}

std::string other_direction(const RigFile& rig) {
  if (rig.turntable_driver == "grbl")
    return "reverse the motor (GRBL: change $3 from 0 to 1, or exchange the two wires of one of its coils)";
  if (rig.turntable_driver == "zaber") return "reverse the stage (send \"set driver.dir 1\", and home it)";
  return "turn it counter-clockwise, seen from above, for larger angles";
}

// Writes what the pictures say into the draft; returns what a person should know of it.
std::vector<std::string> take(const calibration::BenchSketch& sketch, const RigFile& rig, cv::Size size,
                              RigDraft& draft) {
  if (sketch.turned_per_reading < 0)
    throw std::runtime_error(
        "the platform turns clockwise, seen from above, when it is told to turn to larger angles; " +
        other_direction(rig) + ", and start again: what was answered is kept");
  std::vector<std::string> said;
  draft["focal_length_guess_px"] = std::lround(sketch.focal_length_px);
  const auto whole = [](const Eigen::Vector3d& v) {
    return RigDraft::array({std::lround(v.x()), std::lround(v.y()), std::lround(v.z())});
  };
  const Eigen::Vector3d up(0, 0, rig.platform_height_mm);
  draft["camera_by_tape"]["position_mm"] = whole(sketch.camera_mm + up);
  draft["camera_by_tape"]["aim_mm"] = whole(sketch.aim_mm + up);
  said.push_back("The camera stands " + number_text(sketch.camera_mm.x(), 0) + " mm from the axis and " +
                 number_text(sketch.camera_mm.z() + up.z(), 0) + " mm above the table; its focal length is about " +
                 number_text(sketch.focal_length_px, 0) + " px.");
  if (rig.camera_wire && !rig.camera_wire->simulated) {
    draft["camera_connection"]["width_px"] = size.width;
    draft["camera_connection"]["height_px"] = size.height;
  }
  const double off = std::abs(sketch.turned_per_reading - 1);
  if (off > kScaleOff && rig.turntable_wire) {
    const double steps = rig.turntable_wire->controller.steps_per_deg / sketch.turned_per_reading;
    draft["turntable_setup"]["steps_per_deg"] = std::round(steps * 1000) / 1000;
    said.push_back(
        "Told to turn by 1 degree, the platform turns by " + number_text(sketch.turned_per_reading, 3) +
        ". The rig file says " + number_text(steps, 3) +
        " steps per degree; bring that to the next value that "
        "motor, microsteps and gear allow, and set the controller to it (\"threadstation turntable set-up\").");
  } else {
    said.push_back("The platform turns counter-clockwise, as it should, by " +
                   number_text(sketch.turned_per_reading, 4) + " degrees for each that it is told.");
  }
  if (std::abs(sketch.roll_rad) > kMostRollDeg * kDegree)
    said.push_back("The camera is tilted sideways by " + degrees(std::abs(sketch.roll_rad)) + "; level it.");
  if (std::abs(sketch.first_tag_rad) > kMostMarkDeg * kDegree)
    said.push_back("At angle 0 the platform's first tag (" + std::to_string(rig.platform_ring.tags.front().id) +
                   ") should look towards the camera and is " + degrees(std::abs(sketch.first_tag_rad)) +
                   " off; turn the platform on its shaft, and leave its sheet of tags where it is.");
  if (std::abs(sketch.aim_mm.y()) > kMostBeside_mm)
    said.push_back("The camera looks past the axis by " + number_text(std::abs(sketch.aim_mm.y()), 0) +
                   " mm; point it at the middle of the platform.");
  return said;
}

}  // namespace

std::vector<std::string> make_rig(const NewRigRequest& request) {
  watch_interrupts();
  if (fs::exists(request.out))
    throw std::runtime_error(request.out.string() + " is there already and is not overwritten; give --out a new name");
  rig::AskedPerson& asked = *request.asked;
  const fs::path kept = request.out.string() + ".draft";
  std::vector<std::string> said;
  RigDraft draft;
  if (fs::exists(kept)) {
    draft = draft_from(kept);
    said.push_back("Went on from what was answered before (" + kept.string() + ").");
  } else {
    fs::path like = request.like;
    if (like.empty()) like = data_folder() / "rigs" / (ask_for_ready_rig(asked) + ".json");
    read_rig(like);  // its errors are said before anything is asked
    draft = draft_from(like);
  }
  const auto keep = [&] { write_text_file(kept, draft.dump(2) + "\n"); };
  if (draft.at("operator") == "console") {
    ask_for_ports(draft, asked);
    keep();
    ask_for_measures(draft, asked, keep);
  }
  RigFile rig = parsed(draft, request.out);
  if (rig.turntable_wire) {
    draft["turntable_setup"]["steps_per_deg"] = controller_steps_per_deg(rig);
    keep();
    rig = parsed(draft, request.out);
  }
  ProgressDisplay progress("look at the platform", request.progress_style);
  const RigDevices devices = open_rig(rig, std::nullopt, &asked);
  make_drawing_operator(*devices.person, asked)->arrange({.room_light = true});
  devices.turntable->home();
  cv::Size size;
  const auto sightings = look(rig, devices, size, progress);
  devices.turntable->move_to(0);  // where a person looks which tag faces the camera
  const calibration::BenchSketch sketch = calibration::sketch_bench(rig.platform_ring, size, sightings);
  progress.finish("done");
  for (std::string& sentence : take(sketch, rig, size, draft)) said.push_back(std::move(sentence));
  parsed(draft, request.out);
  write_text_file(request.out, commented_json(draft, read_key_meanings(data_folder() / "rigs/README.md")));
  fs::remove(kept);
  return said;
}

}  // namespace station
