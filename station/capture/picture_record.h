// The journal's record of one picture (event "picture"), and which records hold after all that came later.
//
// A later picture of a step replaces the earlier one. An event "discarded" {"file", "reason"} takes back every record
// that names that file. A dark that needs the exposure of an earlier dark names that one's file and step (`same_as`).
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rig/camera.h"
#include "station/capture/journal.h"
#include "station/capture/plan.h"
#include "station/capture/verdict.h"

namespace station {

struct PictureRecord {
  std::string step;    // id in the plan
  std::string file;    // in the session folder: "raw/reflection-horizontal-1.arw"
  std::string sha256;  // of the file
  std::uint64_t bytes = 0;
  StepKind kind = StepKind::view;
  rig::Mounting mounting = rig::Mounting::horizontal;
  rig::Lamp lamp = rig::Lamp::off;
  bool room_light = false;
  double asked_angle_rad = 0, read_angle_rad = 0;  // of the platform
  rig::ExposureSettings asked, read;               // of the camera; `read` came with the picture
  std::string utc;                                 // when the exposure began
  std::string same_as;                             // a dark's only: the step whose file this is
  Verdict verdict;
};

nlohmann::json picture_to_json(const PictureRecord& picture);

// Errors: std::runtime_error that names the record.
PictureRecord picture_from_json(const JournalRecord& record);

// By step. Errors as above.
std::map<std::string, PictureRecord> taken_pictures(const std::vector<JournalRecord>& records);

// Takes back every record that names `file`.
void forget_file(std::map<std::string, PictureRecord>& taken, const std::string& file);

}  // namespace station
