// What the simulated bench looks like: the spool as fibers, printed targets, platform, table and lamps, path-traced.
#pragma once

#include <optional>

#include "rig/simulated/simulated_bench.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"

namespace station {

// The function that rig's simulated camera calls. `spool` may be absent as long as no holder is drawn.
// Throws std::runtime_error when the spool has no "simulation" part or its fibers do not fit into the thread.
rig::DrawPicture make_bench_picture(const RigFile& rig, const std::optional<Spool>& spool);

}  // namespace station
