// What a plan still wants, told by the pictures that were taken so far (`taken`: by step, as Recorder::taken).
#pragma once

#include <map>
#include <optional>
#include <string>

#include "rig/devices/camera.h"
#include "station/documents/plan.h"
#include "station/session/record/picture_record.h"

namespace station {

// The steps that are needed (bracket.h) and have no picture, in the plan's order. A picture of a dark or of a bracket's
// exposure does not count when its view was taken again at another exposure.
Plan open_steps(const Plan& plan, const std::map<std::string, PictureRecord>& taken);

// The camera's settings for a dark or a bracket's exposure: those of its view, which is taken already, so many stops
// longer.
rig::CameraSettings repeated_settings(const PlanStep& step, const std::map<std::string, PictureRecord>& taken);

// Another dark's picture that serves for this step too; nothing for a step that is no dark.
std::optional<PictureRecord> dark_that_serves(const PlanStep& step, const std::map<std::string, PictureRecord>& taken);

}  // namespace station
