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
#include "station/documents/views_file.h"

namespace station {

struct SessionFile {
  std::string utc, software;
  std::string person;            // who captured the session; may be empty
  std::optional<Sample> sample;  // what the queue's list said of the spool
  RigFile rig;                   // only its name where views were measured elsewhere
  Spool spool;
  Plan plan;
  // Views that another lab measured, instead of a capture on a rig: their pictures in raw/, and their masks, where they
  // came with any, in calibration/.
  std::optional<DevelopedViews> measured;
};

// Makes the document from its parts; `rig` and `spool` are whole documents of their own kinds.
nlohmann::json make_session_document(const std::string& utc, const nlohmann::json& rig, const nlohmann::json& spool,
                                     const Plan& plan, const std::string& person = {},
                                     const std::optional<Sample>& sample = {});
// The same of views that were measured elsewhere.
nlohmann::json make_measured_document(const std::string& utc, const nlohmann::json& spool, const Plan& plan,
                                      const DevelopedViews& measured, const std::string& person);
// Errors: std::runtime_error, one line that ends with `so`, where the session's views were measured elsewhere.
void require_captured(const SessionFile& session, const std::filesystem::path& folder, const std::string& so);
SessionFile read_session_file(const std::filesystem::path& session);  // `session` is the folder

// The program's name and version: "threadstation 0.1.0".
std::string software_version();

}  // namespace station
