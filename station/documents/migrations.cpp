#include "station/documents/migrations.h"

#include <map>
#include <stdexcept>
#include <string_view>

namespace station {
namespace {

using nlohmann::json;

// Adds the keys that are missing, also those of objects within.
void add_missing(json& object, const json& keys) {
  if (!object.is_object()) return;  // the reader refuses it
  for (const auto& [key, value] : keys.items())
    if (!object.contains(key))
      object[key] = value;
    else if (value.is_object() && object[key].is_object())
      add_missing(object[key], value);
}

// Version 1 of a rig grew keys in its first day. A file without them has no tags but those of board, holder and
// Spectralon (the prints of `target` stand for what it does not name), one exposure a view, and a bench without flaws.
json rig_1_to_2(json rig) {
  add_missing(rig, json::parse(R"({
    "camera_setup": {"lens": "unknown", "focus": "unknown", "calibration_valid_days": 30},
    "platform": {"ring": {"count": 12, "radius_mm": 60, "tag_mm": 14, "first_id": 300}},
    "table_tags": {"tag_mm": 24, "first_id": 400,
      "centres_mm": [-128, -67, -128, 67, -172, -71, -172, 71, -216, -71, -216, 71]},
    "lamp_tags": {"tag_mm": 20, "offset_mm": 30, "first_id": 500},
    "lamp_by_tape": {"aim_mm": [0, 0, 64]},
    "capture": {"bracket_stops": []}})"));
  if (!rig.contains("simulation")) return rig;
  const json aim = rig["lamp_by_tape"].is_object() ? rig["lamp_by_tape"]["aim_mm"] : json();
  add_missing(rig["simulation"], json::parse(R"({
    "sensor": {"defects": {"hot_fraction": 0, "hot_dark_current_e_s": 0, "dead_fraction": 0, "noisy_fraction": 0,
      "sensitivity_spread": 0, "offset_spread_dn": 0, "dust_spots": 0, "dust_depth": 0, "dust_radius_px": 0,
      "nonlinearity": 0, "shutter_spread": 0}},
    "lens": {"blur_px": 0},
    "lamp": {"beam_exponent": 0,
      "changes": {"drift_per_s": 0, "jump": 0, "jump_at_s": 0, "pwm_hz": 0, "pwm_duty": 1}},
    "prints": {"ring_offset_mm": [0, 0], "ring_turn_deg": 0, "table_offset_mm": [0, 0], "table_turn_deg": 0},
    "room_leak": 0, "board_bow_mm": 0, "spectralon_droop_percent": 0})"));
  add_missing(rig["simulation"], {{"lamp", {{"front_aim_mm", aim}, {"back_aim_mm", aim}}}});
  return rig;
}

using Step = json (*)(json);

// Each kind with its steps, the first from version 1.
const std::map<std::string, std::vector<Step>>& kinds() {
  static const std::map<std::string, std::vector<Step>> all{{"batch", {}},
                                                            {"batch-items", {}},
                                                            {"batch-task", {}},
                                                            {"board", {}},
                                                            {"bundle", {}},
                                                            {"calibration", {}},
                                                            {"calibration_pictures", {}},
                                                            {"checkpoint", {}},
                                                            {"draft", {}},
                                                            {"fabric", {}},
                                                            {"faults", {}},
                                                            {"fiber", {}},
                                                            {"figure", {}},
                                                            {"import", {}},
                                                            {"lens", {}},
                                                            {"manifest", {}},
                                                            {"measurement", {}},
                                                            {"patch", {}},
                                                            {"plan", {}},
                                                            {"platform-place", {}},
                                                            {"rig", {rig_1_to_2}},
                                                            {"sample", {}},
                                                            {"scene", {}},
                                                            {"session", {}},
                                                            {"spool", {}},
                                                            {"thread", {}},
                                                            {"turntable-settings", {}},
                                                            {"views", {}},
                                                            {"yarn", {}}};
  return all;
}

constexpr std::string_view kPrefix = "threadstation/";

}  // namespace

std::vector<std::string> document_kinds() {
  std::vector<std::string> names;
  for (const auto& [kind, steps] : kinds()) names.push_back(kind);
  return names;
}

int current_version(const std::string& kind) {
  return 1 + static_cast<int>(kinds().at(kind).size());
}

json migrated(json document, const std::string& kind, int version) {
  for (; version < current_version(kind); ++version)
    document = kinds().at(kind)[static_cast<std::size_t>(version - 1)](std::move(document));
  document["version"] = version;
  return document;
}

std::string later_version_problem(const std::string& source, const std::string& kind, int version) {
  return source + ": made by a later threadstation: " + kind + " version " + std::to_string(version) +
         ", this one reads up to version " + std::to_string(current_version(kind)) + "; install the later one";
}

json up_to_date(const json& document, const std::string& source) {
  if (!document.is_structured()) return document;
  json whole = document;
  for (json& part : whole) part = up_to_date(part, source);
  if (!whole.is_object() || !whole.contains("format") || !whole["format"].is_string() || !whole.contains("version") ||
      !whole["version"].is_number_integer())
    return whole;
  const auto format = whole["format"].get<std::string>();
  if (!format.starts_with(kPrefix) || !kinds().contains(format.substr(kPrefix.size()))) return whole;
  const std::string kind = format.substr(kPrefix.size());
  const int version = whole["version"].get<int>();
  if (version > current_version(kind)) throw std::runtime_error(later_version_problem(source, kind, version));
  return version < 1 ? whole : migrated(std::move(whole), kind, version);
}

}  // namespace station
