#include "station/bench/set_up/rig_review.h"

#include <cmath>
#include <optional>

#include "calibration/geometry/targets.h"
#include "station/bench/calibrate/calibration_plan.h"
#include "station/bench/calibrate/lamps.h"
#include "station/data/data_folder.h"
#include "station/documents/commented_json.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/rig_file.h"

namespace station {
namespace {

using nlohmann::json;

constexpr int kMostFaults = 100;                     // in one file
constexpr double kSmallestTag_px = 24;               // 8 cells of a tag, three pixels each
constexpr const char* kExampleAdapter = "A50285BI";  // of station/data/rigs/grbl_sony_usb.json

// The ready rig file whose devices are of the same kind.
json ready_rig_like(const json& document) {
  const std::string camera = document.value("camera", "gphoto2"), turntable = document.value("turntable", "grbl");
  const bool simulated = document.contains("simulation");
  std::string name = turntable + "_sony_usb";
  if (camera == "simulated" || turntable == "simulated")
    name = "simulated";
  else if (simulated && (turntable == "grbl" || turntable == "zaber"))
    name = "simulated_wire_" + turntable;
  const std::filesystem::path file = data_folder() / "rigs" / (name + ".json");
  return read_json_file(std::filesystem::exists(file) ? file : data_folder() / "rigs/grbl_sony_usb.json");
}

json::json_pointer pointer_to(const std::string& key) {
  std::string path = "/" + key;
  for (char& c : path)
    if (c == '.') c = '/';
  return json::json_pointer(path);
}

// Puts right what the error names, so that the next fault can be found; false: it cannot be.
bool mend(json& document, const json& ready, const DocumentError& error) {
  const json::json_pointer at = pointer_to(error.key);
  if (error.unknown) {
    if (!document.contains(at)) return false;
    document.at(at.parent_pointer()).erase(at.back());
    return true;
  }
  if (!ready.contains(at) || (document.contains(at) && document.at(at) == ready.at(at))) return false;
  document[at] = ready.at(at);
  return true;
}

std::string meaning_of(const KeyMeanings& meanings, std::string key) {
  for (; !key.empty(); key = key.find('.') == std::string::npos ? "" : key.substr(0, key.rfind('.')))
    if (const auto found = meanings.find(key); found != meanings.end()) return " (" + key + ": " + found->second + ")";
  return "";
}

// The file as far as it can be read, and what could not.
std::optional<RigFile> read_with_remarks(json& document, const std::string& source, std::vector<RigRemark>& remarks) {
  const json ready = ready_rig_like(document);
  const KeyMeanings meanings = read_key_meanings(data_folder() / "rigs/README.md");
  for (int faults = 0; faults < kMostFaults; ++faults) {
    try {
      return parse_rig(document, source);
    } catch (const DocumentError& error) {
      const std::string meaning = error.unknown ? "" : meaning_of(meanings, error.key);
      remarks.push_back({true, error.what() + meaning + "."});
      if (!mend(document, ready, error)) return std::nullopt;
    } catch (const std::runtime_error& error) {
      remarks.push_back({true, std::string(error.what()) + "."});
      return std::nullopt;
    }
  }
  return std::nullopt;
}

void review_places(const RigFile& rig, std::vector<RigRemark>& remarks) {
  const calibration::RoughCamera camera = panel_bench(rig).camera;
  const double distance = camera.world_from_camera.translation().norm();
  const double tag_px = rig.focal_length_guess_px * rig.platform_ring.tags.front().size_mm / distance;
  if (tag_px < kSmallestTag_px)
    remarks.push_back({true, "At " + number_text(distance, 0) + " mm and a focal length of " +
                                 number_text(rig.focal_length_guess_px, 0) + " px a tag on the platform is " +
                                 number_text(tag_px, 0) + " px wide in the picture, and " +
                                 number_text(kSmallestTag_px, 0) +
                                 " are needed: move the camera nearer, or take a longer lens or larger tags."});
  if (!in_picture(camera, {0, 0, rig.platform_height_mm}))
    remarks.push_back({true,
                       "With camera_by_tape and focal_length_guess_px as they are the platform is not in the "
                       "picture: measure them again, or let \"threadstation rig new\" do it."});
  for (const auto& [name, place] : {std::pair("front", rig.front_lamp_mm), {"back", rig.back_lamp_mm}})
    if (in_picture(camera, place))
      remarks.push_back({true, std::string("The lamp at lamp_by_tape.") + name +
                                   "_position_mm stands in the picture: move it aside, or measure again."});
  if (rig.front_lamp_mm.x() <= 0)
    remarks.push_back({true,
                       "The lamp in front stands behind the platform's axis (the first number of "
                       "lamp_by_tape.front_position_mm is not above 0)."});
  if (rig.back_lamp_mm.x() >= 0)
    remarks.push_back({true,
                       "The lamp behind stands before the platform's axis (the first number of "
                       "lamp_by_tape.back_position_mm is not below 0)."});
}

void review_devices(const RigFile& rig, const std::string& source, std::vector<RigRemark>& remarks) {
  const bool real_camera = rig.camera_driver == "gphoto2" && !rig.camera_wire->simulated;
  const bool real_turntable = rig.turntable_wire && rig.turntable_wire->line != TurntableWire::Line::simulated;
  if (rig.turntable_wire && rig.turntable_wire->port.usb_serial == kExampleAdapter)
    remarks.push_back({true,
                       "turntable_setup.usb_serial is that of the example: \"threadstation devices\" tells what "
                       "your turntable's port is called."});
  if ((real_camera || real_turntable) && rig.operator_driver == "simulated")
    remarks.push_back({true, "The devices are real and the operator is simulated: write \"operator\": \"console\"."});
  if ((real_camera || real_turntable) && rig.simulation)
    remarks.push_back({false, "\"simulation\" is what only a simulated bench knows, and this one is real: remove it."});
  if (real_camera && rig.control_bar_mm == calibration::kControlBar_mm)
    remarks.push_back({false, "control_bar_mm is exactly what is drawn: measure the bar on the print of " + source +
                                  "'s targets, because printers seldom print to scale."});
}

void review_what_may_be_left_out(const RigFile& rig, const json& document, std::vector<RigRemark>& remarks) {
  if (!rig.reference_chip)
    remarks.push_back({false, "There is no reference_patch: a lamp that changes between two views is not noticed."});
  if (!rig.colour_chart)
    remarks.push_back({false, "There is no colour_chart: colours on the screen are those of another camera."});
  if (!document.contains("holder"))
    remarks.push_back({false, "There is no holder: the page cannot make the files of new spools."});
}

}  // namespace

std::vector<RigRemark> review_rig(const std::filesystem::path& file) {
  std::vector<RigRemark> remarks;
  json document = read_json_file(file);
  if (!document.is_object())
    return {{true, file.string() + " holds no JSON object; \"threadstation rig new\" makes a rig file."}};
  const std::optional<RigFile> rig = read_with_remarks(document, file.filename().string(), remarks);
  if (!rig) return remarks;
  review_devices(*rig, file.filename().string(), remarks);
  review_places(*rig, remarks);
  review_what_may_be_left_out(*rig, document, remarks);
  try {
    make_calibration_plan(*rig);
  } catch (const std::runtime_error& error) {
    remarks.push_back({true, std::string(error.what()) + "."});
  }
  return remarks;
}

}  // namespace station
