#include "station/bench/metering.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "station/bench/bench_fault.h"

namespace station {
namespace {

bool within_a_sixth_of_a_stop(double a, double b) {
  return std::abs(std::log2(a / b)) < 1.0 / 6;
}

double offered_time(rig::Camera& camera, double wanted_s) {
  if (!std::isfinite(wanted_s) || wanted_s <= 0) {
    throw std::runtime_error("the metering asked for an exposure of " + std::to_string(wanted_s) +
                             " s; check the light and take the picture again");
  }
  return rig::nearest_shutter_s(camera.shutter_times_s(), wanted_s);
}

}  // namespace

std::string settings_text(const rig::CameraSettings& settings) {
  std::ostringstream text;
  text << settings.exposure_s << " s, ISO " << settings.iso << ", f/" << settings.f_number;
  return text.str();
}

bool same_settings(const rig::CameraSettings& a, const rig::CameraSettings& b) {
  const bool told = a.f_number != 0 && b.f_number != 0;
  return a.iso == b.iso && within_a_sixth_of_a_stop(a.exposure_s, b.exposure_s) &&
         (!told || within_a_sixth_of_a_stop(a.f_number * a.f_number, b.f_number * b.f_number));
}

rig::CameraSettings set_camera(rig::Camera& camera, const rig::CameraSettings& wanted) {
  rig::CameraSettings asked = wanted;
  asked.exposure_s = offered_time(camera, wanted.exposure_s);
  const rig::CameraSettings read = camera.configure(asked);
  if (!same_settings(asked, read)) {
    throw BenchFault("the camera was asked for " + settings_text(asked) + " and stands at " + settings_text(read) +
                     "; set its dial to M (manual) and resume");
  }
  return asked;
}

Metering meter_exposure(rig::Camera& camera, const PlanStep& step, const rig::CameraSettings& first,
                        const ChooseExposure& choose, int most_test_pictures, const std::function<void()>& between) {
  Metering metering{.settings = first, .test_pictures = 0, .converged = false};
  while (!metering.converged && metering.test_pictures < most_test_pictures) {
    between();
    const rig::CameraSettings asked = set_camera(camera, metering.settings);
    const rig::Picture test = camera.capture();
    ++metering.test_pictures;
    const ExposureChoice choice = choose(step, test);
    metering.settings.exposure_s = offered_time(camera, choice.exposure_s);
    metering.converged = choice.done || metering.settings.exposure_s == asked.exposure_s;
  }
  return metering;
}

}  // namespace station
