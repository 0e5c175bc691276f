// What is told of a batch: how far each step is, what its tasks took, and what failed and why.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "station/batch/batch_state.h"

namespace station {

// {"folder", "steps": [{"step", "tasks", by state their number, "processor_s", "seconds_mean", "seconds_most",
// "peak_mib"}], "problems": [{"task", "state", "why", "log"}]}; of tasks that are held only those that failed are told.
nlohmann::json describe_batch(const BatchWork& work, const std::vector<TaskStatus>& states);

// The same as a table and lines for people, and as a self-contained page.
std::string batch_text(const nlohmann::json& description);
std::string batch_page(const nlohmann::json& description);

}  // namespace station
