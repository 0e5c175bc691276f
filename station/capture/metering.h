// Setting the camera and finding the exposure of a picture by test pictures, which are not kept.
#pragma once

#include <functional>
#include <string>

#include "rig/camera.h"
#include "station/capture/plan.h"

namespace station {

struct ExposureChoice {
  double exposure_s = 0;  // for the next test picture, or when done for the picture itself
  bool done = false;
};

// Looks at a test picture (its bytes and the settings read back).
using ChooseExposure = std::function<ExposureChoice(const PlanStep&, const rig::Picture& test)>;

struct Metering {
  rig::ExposureSettings settings;  // to take the picture with: a shutter time that the camera offers
  int test_pictures = 0;
  bool converged = false;  // false: the most test pictures were taken and the choice still moved
};

// Ends when `choose` says done or the camera's nearest shutter time is the one just tested (its longest, for
// example). `between` is called before each test picture and may throw to end the run. Errors: those of the camera;
// std::runtime_error when `choose` asks for a time that is not finite and positive.
Metering meter_exposure(rig::Camera& camera, const PlanStep& step, const rig::ExposureSettings& first,
                        const ChooseExposure& choose, int most_test_pictures, const std::function<void()>& between);

// Sets the camera to the offered shutter time nearest to the wanted one; returns what was asked.
// Errors: std::runtime_error when the camera reads back other settings (a dial, a mode that locks the shutter).
rig::ExposureSettings set_camera(rig::Camera& camera, const rig::ExposureSettings& wanted);

// Equal ISO; shutter and f-number within a sixth of a stop, because cameras round what is engraved (1/30 is 1/32 s).
bool same_settings(const rig::ExposureSettings& a, const rig::ExposureSettings& b);

std::string settings_text(const rig::ExposureSettings& settings);  // "0.25 s, ISO 100, f/8"

}  // namespace station
