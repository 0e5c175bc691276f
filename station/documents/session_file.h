// session.json (kind "session"): what was asked, with the rig, spool and plan as they were, so that the folder alone is
// enough to resume, develop and invert.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "station/capture/plan.h"
#include "station/documents/rig_file.h"
#include "station/documents/sample.h"
#include "station/documents/spool.h"

namespace station {

struct SessionFile {
  std::string utc, software;
  std::string person;            // who captured it; may be empty
  std::optional<Sample> sample;  // what the queue said of the spool
  RigFile rig;
  Spool spool;
  Plan plan;
};

// The document from its parts; `rig` and `spool` are documents of their own kinds.
nlohmann::json make_session_document(const std::string& utc, const nlohmann::json& rig, const nlohmann::json& spool,
                                     const Plan& plan, const std::string& person = {},
                                     const std::optional<Sample>& sample = {});
SessionFile read_session_file(const std::filesystem::path& session);

// "threadstation 0.1.0"
std::string software_version();

}  // namespace station
