// Waits until a lamp that was just switched on has warmed up. Test pictures of one exposure, some seconds apart, show
// the reference chip, by which the lamp is read; they are not kept.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "rig/devices/camera.h"
#include "rig/devices/clock.h"
#include "station/documents/plan.h"

namespace station {

struct LampWatch {
  double interval_s = 10;         // from one reading to the next; 0: the lamp is not watched
  double largest_change = 0.005;  // of a steady lamp's strength in an interval, relative
  double limit_s = 600;           // a lamp that is not steady by then is given up
};

struct LampSettling {
  int test_pictures = 0;
  double waited_s = 0;
  std::optional<double> change;  // relative, in the last interval that was read
  bool readable = true;          // false: the last test picture did not show the lamp's strength
};

// The warning, also written to the journal, about a lamp that cannot be read.
inline constexpr const char* kLampNotWatched =
    "the lamp is not watched while it warms up: its reference chip cannot be read; see that it stands free and lit, "
    "or wait until the lamp is warm before the next session";

// Reads the lamp's strength in a test picture, in any unit; nothing where it cannot be read.
using ReadLamp = std::function<std::optional<double>(const PlanStep&, const rig::Picture& test)>;

// Waits until the lamp is steady. The camera has its settings already. `between` is called every second and before each
// picture, and may throw to end the run; `said` is given a line for the person when the lamp is not steady yet or
// cannot be read. Errors: those of the camera; std::runtime_error when the limit is reached.
LampSettling watch_lamp(rig::Camera& camera, rig::Clock& clock, const PlanStep& step, const LampWatch& watch,
                        const ReadLamp& read, const std::function<void()>& between,
                        const std::function<void(const std::string&)>& said);

}  // namespace station
