// The rig's devices and their state, as the last `check` that the page started has found them.
#pragma once

#include <nlohmann/json.hpp>

#include "station/documents/rig_file.h"
#include "station/serve/workspace.h"

namespace station {

// {"devices": [{"device", "passed" (null: never checked), "rows": [{"name", "passed", "what"}]}], "checked_ms": when,
// since 1970; null: never}.
nlohmann::json checked_devices(const Workspace& workspace, const RigFile& rig);

// {"passed": whether all devices passed the last check (null: never checked), "checked_ms": when}
nlohmann::json devices_summary(const Workspace& workspace);

}  // namespace station
