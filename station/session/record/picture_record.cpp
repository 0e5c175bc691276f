#include "station/session/record/picture_record.h"

#include <stdexcept>

#include "rig/cameras/camera_frames.h"
#include "station/documents/degree.h"
#include "station/documents/plan_file.h"

namespace station {
namespace {

using nlohmann::json;

StepKind kind_from_record(const std::string& name) {
  for (const StepKind kind : {StepKind::pose, StepKind::view, StepKind::bracket, StepKind::dark})
    if (name == kind_name(kind)) return kind;
  throw std::runtime_error("the kind of step '" + name + "' is not known");
}

}  // namespace

json picture_to_json(const PictureRecord& picture) {
  json document = {{"step", picture.step},
                   {"file", picture.file},
                   {"sha256", picture.sha256},
                   {"bytes", picture.bytes},
                   {"kind", kind_name(picture.kind)},
                   {"mounting", mounting_name(picture.mounting)},
                   {"lamp", lamp_name(picture.lamp)},
                   {"room_light", picture.room_light},
                   {"platform_angle_asked_deg", file_degrees(picture.asked_angle_rad)},
                   {"platform_angle_read_deg", file_degrees(picture.read_angle_rad)},
                   {"camera_asked", rig::settings_to_json(picture.asked)},
                   {"camera_read", rig::settings_to_json(picture.read)},
                   {"exposure_utc", picture.utc},
                   {"verdict", verdict_to_json(picture.verdict)}};
  if (!picture.same_as.empty()) document["same_as"] = picture.same_as;
  return document;
}

PictureRecord picture_from_json(const JournalRecord& record) {
  try {
    const json& data = record.data;
    return {.step = data.at("step").get<std::string>(),
            .file = data.at("file").get<std::string>(),
            .sha256 = data.at("sha256").get<std::string>(),
            .bytes = data.at("bytes").get<std::uint64_t>(),
            .kind = kind_from_record(data.at("kind").get<std::string>()),
            .mounting = mounting_from_name(data.at("mounting").get<std::string>()),
            .lamp = lamp_from_name(data.at("lamp").get<std::string>()),
            .room_light = data.at("room_light").get<bool>(),
            .asked_angle_rad = data.at("platform_angle_asked_deg").get<double>() * kDegree,
            .read_angle_rad = data.at("platform_angle_read_deg").get<double>() * kDegree,
            .asked = rig::settings_from_json(data.at("camera_asked")),
            .read = rig::settings_from_json(data.at("camera_read")),
            .utc = data.at("exposure_utc").get<std::string>(),
            .same_as = data.value("same_as", std::string()),
            .verdict = verdict_from_json(data.at("verdict"))};
  } catch (const std::exception& error) {
    throw std::runtime_error("journal record " + std::to_string(record.seq) + " is no picture that can be read (" +
                             error.what() + "); it may come from another version of the program");
  }
}

std::map<std::string, PictureRecord> taken_pictures(const std::vector<JournalRecord>& records) {
  std::map<std::string, PictureRecord> taken;
  for (const JournalRecord& record : records) {
    if (record.event == "picture") {
      PictureRecord picture = picture_from_json(record);
      const std::string step = picture.step;
      taken.insert_or_assign(step, std::move(picture));
    } else if (record.event == "discarded") {
      forget_file(taken, record.data.value("file", std::string()));
    }
  }
  return taken;
}

void forget_file(std::map<std::string, PictureRecord>& taken, const std::string& file) {
  std::erase_if(taken, [&](const auto& entry) { return entry.second.file == file; });
}

}  // namespace station
