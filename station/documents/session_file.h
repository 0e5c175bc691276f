// The file session.json of a session (kind "session"): what was asked, with copies of the rig, spool and plan as they
// were, so that the folder alone is enough to resume, develop and invert.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "station/documents/plan.h"
#include "station/documents/rig_file.h"
#include "station/documents/sample.h"
#include "station/documents/spool.h"

namespace station {

struct SessionFile {
  std::string utc, software;
  std::string person;            // who captured the session; may be empty
  std::optional<Sample> sample;  // what the queue's list said of the spool
  RigFile rig;
  Spool spool;
  Plan plan;
};

// Makes the document from its parts; `rig` and `spool` are whole documents of their own kinds.
nlohmann::json make_session_document(const std::string& utc, const nlohmann::json& rig, const nlohmann::json& spool,
                                     const Plan& plan, const std::string& person = {},
                                     const std::optional<Sample>& sample = {});
SessionFile read_session_file(const std::filesystem::path& session);  // `session` is the folder

// The program's name and version: "threadstation 0.1.0".
std::string software_version();

}  // namespace station
