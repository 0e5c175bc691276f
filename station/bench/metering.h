// Sets the camera, and finds the exposure time of a picture by test pictures, which are not kept.
#pragma once

#include <functional>
#include <string>

#include "rig/devices/camera.h"
#include "station/documents/plan.h"

namespace station {

struct ExposureChoice {
  double exposure_s = 0;  // for the next test picture, or when done for the picture itself
  bool done = false;
};

// A function that looks at a test picture (its bytes and the settings read back) and chooses what comes next.
using ChooseExposure = std::function<ExposureChoice(const PlanStep&, const rig::Picture& test)>;

struct Metering {
  rig::CameraSettings settings;  // to take the picture with: a shutter time that the camera offers
  int test_pictures = 0;
  bool converged = false;  // false: the most test pictures were taken and the choice still moved
};

// Takes test pictures until `choose` says done or the camera's nearest shutter time is the one just tested (its
// longest, for example). `between` is called before each test picture and may throw to end the run. Errors: those of
// the camera; std::runtime_error when `choose` asks for a time that is not finite and positive.
Metering meter_exposure(rig::Camera& camera, const PlanStep& step, const rig::CameraSettings& first,
                        const ChooseExposure& choose, int most_test_pictures, const std::function<void()>& between);

// Sets the camera to the offered shutter time nearest to the wanted one; returns what was asked.
// Errors: BenchFault when the camera reads back other settings (a dial, a mode that locks the shutter).
rig::CameraSettings set_camera(rig::Camera& camera, const rig::CameraSettings& wanted);

// Whether the ISO is equal, and shutter time and f-number agree within a sixth of a stop: cameras round what is
// engraved (1/30 is 1/32 s). An f-number of 0, of a file whose lens does not tell it, agrees with any.
bool same_settings(const rig::CameraSettings& a, const rig::CameraSettings& b);

std::string settings_text(const rig::CameraSettings& settings);  // "0.25 s, ISO 100, f/8"

}  // namespace station
