#include "station/session/capture/open_steps.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "station/bench/metering.h"
#include "station/session/record/bracket.h"

namespace station {
namespace {

bool is_open(const PlanStep& step, const std::map<std::string, PictureRecord>& taken) {
  if (!is_needed(step, taken)) return false;
  const auto found = taken.find(step.id);
  if (found == taken.end() || step.exposure_of.empty()) return found == taken.end();
  return !taken.contains(step.exposure_of) || !same_settings(found->second.asked, repeated_settings(step, taken));
}

}  // namespace

Plan open_steps(const Plan& plan, const std::map<std::string, PictureRecord>& taken) {
  Plan open;
  std::ranges::copy_if(plan.steps, std::back_inserter(open.steps),
                       [&](const PlanStep& step) { return is_open(step, taken); });
  return open;
}

rig::CameraSettings repeated_settings(const PlanStep& step, const std::map<std::string, PictureRecord>& taken) {
  rig::CameraSettings settings = taken.at(step.exposure_of).asked;
  settings.exposure_s *= std::exp2(step.stops);
  return settings;
}

std::optional<PictureRecord> dark_that_serves(const PlanStep& step, const std::map<std::string, PictureRecord>& taken) {
  if (step.kind != StepKind::dark) return std::nullopt;
  const rig::CameraSettings wanted = repeated_settings(step, taken);
  for (const auto& [id, picture] : taken)
    if (id != step.id && picture.kind == StepKind::dark && picture.same_as.empty() &&
        same_settings(picture.asked, wanted))
      return picture;
  return std::nullopt;
}

}  // namespace station
