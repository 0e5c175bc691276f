// The devices that a rig file names, connected and ready, with their clock.
#pragma once

#include <iosfwd>
#include <memory>
#include <optional>

#include "rig/camera.h"
#include "rig/clock.h"
#include "rig/operator.h"
#include "rig/simulated_bench.h"
#include "rig/turntable.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"

namespace station {

struct RigDevices {
  std::unique_ptr<rig::Clock> clock;
  std::unique_ptr<rig::SimulatedBench> bench;  // absent on a real rig
  std::unique_ptr<rig::Camera> camera;
  std::unique_ptr<rig::Turntable> turntable;
  std::unique_ptr<rig::Operator> person;
};

// `spool`: what is wrapped on the holder; a simulated bench needs it to draw the holder.
// `unattended`: nobody is asked; refused when the rig's operator is a person.
RigDevices open_rig(const RigFile& rig, const std::optional<Spool>& spool, bool unattended);

}  // namespace station
