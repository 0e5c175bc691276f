// Batches below the workspace (batches/<name>, made by threadstation batch) as the page shows them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "station/serve/http_message.h"
#include "station/serve/workspace.h"

namespace station {

// [{"name", "folder", "steps", "problems"}], the last three as describe_batch (batch/batch_report.h) has them, or
// {"name", "problem"} of one that cannot be read, or whose Slurm does not answer.
nlohmann::json batches_document(const Workspace& workspace);
// The report of one as a page of its own. Throws Refused (404) when there is none.
std::string batch_report_page(const Workspace& workspace, const std::string& name);
// Stops one; returns what was done. Throws Refused (404) when there is none, (409) where it cannot be stopped.
std::string stop_batch(const Workspace& workspace, const std::string& name);

}  // namespace station
