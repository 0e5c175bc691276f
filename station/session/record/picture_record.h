// The journal's record of one picture (event "picture"), and the rule for which records still count in the end.
//
// A later picture of a step replaces the earlier one. An event "discarded" {"file", "reason"} takes back every record
// that names that file. A dark that needs the exposure of an earlier dark takes no picture: its record names that one's
// file and step (`same_as`).
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rig/devices/camera.h"
#include "station/documents/plan.h"
#include "station/session/record/journal.h"
#include "station/session/record/verdict.h"

namespace station {

struct PictureRecord {
  std::string step;    // id in the plan
  std::string file;    // in the session folder: "raw/reflection-horizontal-1.arw"
  std::string sha256;  // the file's
  std::uint64_t bytes = 0;
  StepKind kind = StepKind::view;
  rig::Mounting mounting = rig::Mounting::horizontal;
  rig::Lamp lamp = rig::Lamp::off;
  bool room_light = false;
  double asked_angle_rad = 0, read_angle_rad = 0;  // the platform's
  rig::CameraSettings asked, read;                 // the camera's; `read` came with the picture
  std::string utc;                                 // when the exposure began
  std::string same_as;                             // darks only: the step that the file was taken for
  Verdict verdict;
};

nlohmann::json picture_to_json(const PictureRecord& picture);

// Errors: std::runtime_error that names the record.
PictureRecord picture_from_json(const JournalRecord& record);

// The pictures that count after all records, by step. Errors: as above.
std::map<std::string, PictureRecord> taken_pictures(const std::vector<JournalRecord>& records);

// Removes every record that names `file`.
void forget_file(std::map<std::string, PictureRecord>& taken, const std::string& file);

}  // namespace station
