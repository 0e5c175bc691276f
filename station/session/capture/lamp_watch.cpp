#include "station/session/capture/lamp_watch.h"

#include <cmath>
#include <stdexcept>

#include "station/documents/number_text.h"

namespace station {
namespace {

std::string drift_text(double change, const LampWatch& watch) {
  return formatted("%.1f %% in %.0f s, %.1f %% is steady", 100 * std::abs(change), watch.interval_s,
                   100 * watch.largest_change);
}

void sleep_and_poll(rig::Clock& clock, double duration_s, const std::function<void()>& between) {
  const int seconds = std::max(1, static_cast<int>(std::ceil(duration_s)));
  for (int i = 0; i < seconds; ++i) {
    between();
    clock.sleep_s(duration_s / seconds);
  }
}

}  // namespace

LampSettling watch_lamp(rig::Camera& camera, rig::Clock& clock, const PlanStep& step, const LampWatch& watch,
                        const ReadLamp& read, const std::function<void()>& between,
                        const std::function<void(const std::string&)>& said) {
  LampSettling settling;
  const auto reading = [&] {
    between();
    ++settling.test_pictures;
    return read(step, camera.capture());
  };
  std::optional<double> before = reading();
  settling.readable = before.has_value();
  while (before) {
    sleep_and_poll(clock, watch.interval_s, between);
    settling.waited_s += watch.interval_s;
    const std::optional<double> now = reading();
    settling.readable = now.has_value();
    if (!now) break;
    settling.change = *now / *before - 1;
    if (std::abs(*settling.change) <= watch.largest_change) break;
    const std::string drift = drift_text(*settling.change, watch);
    if (settling.waited_s >= watch.limit_s)
      throw std::runtime_error("'" + step.id + "': the lamp still changes after " +
                               std::to_string(std::lround(settling.waited_s)) + " s (" + drift +
                               "); see that its battery is full and nothing dims it, let it cool or take another, "
                               "then resume");
    if (said)
      said("the lamp is warming up (" + drift + "): waiting, " + std::to_string(std::lround(settling.waited_s)) +
           " s so far, at most " + std::to_string(std::lround(watch.limit_s)) + " s");
    before = now;
  }
  if (!settling.readable && said) said("'" + step.id + "': " + kLampNotWatched);
  return settling;
}

}  // namespace station
