#include "rig/devices/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace rig {

bool is_raw_extension(std::string_view extension) {
  constexpr std::array<std::string_view, 12> kKnown{"arw", "cr2", "cr3", "crw", "dng", "nef",
                                                    "nrw", "orf", "pef", "raf", "rw2", "srw"};
  return std::ranges::find(kKnown, extension) != kKnown.end();
}

double nearest_shutter_s(const std::vector<double>& offered_s, double wanted_s) {
  if (offered_s.empty()) {
    throw std::runtime_error("an exposure of " + std::to_string(wanted_s) +
                             " s was asked, but the camera offers no shutter times; set it to manual mode (M)");
  }
  if (!std::isfinite(wanted_s) || wanted_s <= 0)
    throw std::runtime_error("an exposure of " + std::to_string(wanted_s) + " s was asked; it must be a positive time");
  const auto distance_stops = [&](double offered) { return std::abs(std::log2(offered / wanted_s)); };
  return *std::ranges::min_element(offered_s, {}, distance_stops);
}

}  // namespace rig
