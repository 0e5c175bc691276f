#include "rig/devices/device_contract.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <functional>
#include <future>
#include <limits>
#include <optional>
#include <sstream>
#include <thread>
#include <utility>

#include "rig/devices/degree.h"

namespace rig {
namespace {
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Verdict {
  bool passed;
  std::string what;
};

ContractRow row(std::string name, const std::function<Verdict()>& check) {
  try {
    const Verdict verdict = check();
    return {std::move(name), verdict.passed, verdict.what};
  } catch (const std::exception& error) {
    return {std::move(name), false, error.what()};
  }
}

template <typename... Parts>
std::string words(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

// The message of the exception that `action` threw; nothing when it was done.
std::optional<std::string> refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return std::nullopt;
}

std::string degrees(double angle_rad) {
  return words(angle_rad / kDegree, " deg");
}

// ---------------------------------------------------------------------------------------------- the turntable's rows

Verdict homing(Turntable& turntable, double tolerance_rad) {
  turntable.home();
  const double angle_rad = turntable.angle_rad();
  return {std::abs(angle_rad) <= tolerance_rad && turntable.state() == TurntableState::idle,
          "reads " + degrees(angle_rad)};
}

Verdict moves(Turntable& turntable, double tolerance_rad) {
  double worst_rad = 0;
  bool idle = true;
  for (const double wanted_deg : {30.0, 90.0, 45.5, 0.0, -15.0}) {
    turntable.move_to(wanted_deg * kDegree);
    worst_rad = std::max(worst_rad, std::abs(turntable.angle_rad() - wanted_deg * kDegree));
    idle = idle && turntable.state() == TurntableState::idle;
  }
  return {idle && worst_rad <= tolerance_rad,
          words("worst reading off by ", degrees(worst_rad), idle ? "" : ", and it was not idle after a move")};
}

Verdict return_to_zero(Turntable& turntable, double tolerance_rad) {
  turntable.move_to(0);
  const double first_rad = turntable.angle_rad();
  turntable.move_to(60 * kDegree);
  turntable.move_to(0);
  const double second_rad = turntable.angle_rad();
  return {std::abs(first_rad - second_rad) <= tolerance_rad / 2,
          "reads " + degrees(first_rad) + ", then " + degrees(second_rad)};
}

Verdict refuses(Turntable& turntable, double angle_rad) {
  const double before_rad = turntable.angle_rad();
  const auto said = refusal([&] { turntable.move_to(angle_rad); });
  const double moved_rad = std::abs(turntable.angle_rad() - before_rad);
  return {said && moved_rad == 0, said ? *said + words("; moved by ", degrees(moved_rad)) : "it was accepted"};
}

constexpr double kStopAfterRad = 5 * kDegree;
constexpr double kMostWayRad = 5 * kDegree;
constexpr double kMostLateRad = 4 * kDegree;  // a tenth of a second of the fastest platform that stops in time
constexpr int kMostStops = 5;

struct Stop {
  bool seen_turning = false;  // a reading on the way, at which the stop was asked for
  double asked_at_rad = 0;
  double late_rad = 0;                      // between two readings: so far on the platform may have been
  std::optional<std::string> ended_with{};  // what the move threw; nothing when it had arrived before
};

// Turns from 0 to 90 degrees in another thread and stops the platform from this one, once it is seen to be on its way.
Stop stop_on_the_way(Turntable& turntable) {
  turntable.move_to(0);
  Stop stop;
  std::future<void> move = std::async(std::launch::async, [&] { turntable.move_to(90 * kDegree); });
  while (move.wait_for(std::chrono::seconds(0)) != std::future_status::ready && !stop.seen_turning) {
    if (turntable.state() != TurntableState::moving) continue;
    const double before_rad = std::exchange(stop.asked_at_rad, turntable.angle_rad());
    stop.late_rad = std::clamp(stop.asked_at_rad - before_rad, stop.late_rad, kMostLateRad);
    stop.seen_turning = stop.asked_at_rad > kStopAfterRad && stop.asked_at_rad < 90 * kDegree - kStopAfterRad;
  }
  if (stop.seen_turning) turntable.stop();
  stop.ended_with = refusal([&] { move.get(); });
  return stop;
}

// A very quick device may arrive before the stop reaches it, and this thread may be held up between a reading and its
// stop, so there are several tries.
Verdict stopping(Turntable& turntable, double tolerance_rad, bool has_motor) {
  if (!has_motor) return {true, "a hand turns it, there is nothing to stop"};
  Stop stop;
  bool seen_turning = false, in_time = false;
  double stood_rad = 0;
  for (int tries = 0; tries < kMostStops && !in_time; ++tries) {
    stop = stop_on_the_way(turntable);
    seen_turning = seen_turning || stop.seen_turning;
    if (!stop.ended_with) continue;
    if (turntable.state() == TurntableState::unknown_position)
      return {false, "the position was lost: " + *stop.ended_with};
    stood_rad = turntable.angle_rad();
    in_time = std::abs(stood_rad - stop.asked_at_rad) <= kMostWayRad + stop.late_rad;
  }
  if (!stop.ended_with)
    return {false, seen_turning ? words("it turned on to its target after each of ", kMostStops, " stops")
                                : words("it was asked to turn ", kMostStops,
                                        " times and never seen turning, so no stop was tried")};
  const TurntableState state = turntable.state();
  const std::string seen = words("told to stop at ", degrees(stop.asked_at_rad), ", stood at ", degrees(stood_rad));
  if (!in_time)
    return {false, seen + words(", more than 5 deg on, in each of ", kMostStops,
                                " tries; let it turn more slowly or slow down faster")};
  turntable.move_to(10 * kDegree);
  const double then_rad = turntable.angle_rad();
  return {state == TurntableState::stopped && std::abs(then_rad - 10 * kDegree) <= tolerance_rad,
          words(seen, state == TurntableState::stopped ? "" : " in an unknown state",
                "; a move to 10 deg then ended at ", degrees(then_rad))};
}

// ------------------------------------------------------------------------------------------------- the camera's rows

bool same_time(double a_s, double b_s) {
  return std::abs(a_s - b_s) <= 1e-6 * b_s;
}

bool same_settings(const CameraSettings& a, const CameraSettings& b) {
  return same_time(a.exposure_s, b.exposure_s) && a.iso == b.iso && std::abs(a.f_number - b.f_number) < 1e-3;
}

std::string settings_text(const CameraSettings& settings) {
  return words(settings.exposure_s, " s, ISO ", settings.iso, ", f/", settings.f_number);
}

Verdict identity(Camera& camera) {
  const CameraIdentity found = camera.identity();
  return {
      !found.make.empty() && !found.model.empty() && !found.serial.empty() && found.width_px > 0 && found.height_px > 0,
      words(found.make, " ", found.model, ", serial ", found.serial, ", ", found.width_px, " x ", found.height_px)};
}

Verdict shutter_times(Camera& camera) {
  const std::vector<double> times_s = camera.shutter_times_s();
  const bool ascending = std::ranges::adjacent_find(times_s, std::greater_equal<>()) == times_s.end();
  return {!times_s.empty() && times_s.front() > 0 && ascending, words(times_s.size(), " times")};
}

Verdict settings_read_back(Camera& camera) {
  const std::vector<double> times_s = camera.shutter_times_s();
  for (const std::size_t index : {std::size_t{0}, times_s.size() / 2, times_s.size() - 1}) {
    const CameraSettings wanted{times_s.at(index), 100, 8.0};
    const CameraSettings found = camera.configure(wanted);
    if (!same_settings(found, wanted))
      return {false, "asked " + settings_text(wanted) + ", found " + settings_text(found)};
  }
  return {true, "shortest, middle and longest time at ISO 100, f/8"};
}

// A camera asked for a time between two that it offers must say which one it took.
Verdict offered_time(Camera& camera) {
  const std::vector<double> times_s = camera.shutter_times_s();
  const double wanted_s = times_s.at(times_s.size() / 2) * 1.02;
  const double found_s = camera.configure({wanted_s, 100, 8.0}).exposure_s;
  const bool offered = std::ranges::any_of(times_s, [&](double time_s) { return same_time(found_s, time_s); });
  return {offered, words("asked ", wanted_s, " s, found ", found_s, " s")};
}

Verdict refuses_exposure(Camera& camera, double exposure_s) {
  const auto said = refusal([&] { camera.configure({exposure_s, 100, 8.0}); });
  return {said.has_value(), said.value_or("it was accepted")};
}

Verdict picture_as_configured(Camera& camera) {
  const CameraSettings wanted = camera.configure({0.01, 100, 8.0});
  const Picture picture = camera.capture();
  return {!picture.bytes.empty() && !picture.extension.empty() && !picture.utc.empty() &&
              same_settings(picture.settings, wanted),
          words(picture.bytes.size(), " bytes .", picture.extension, ", ", settings_text(picture.settings), ", ",
                picture.utc)};
}

// Each picture must be a new one: cameras have been seen to deliver the previous one again.
Verdict fresh_pictures(Camera& camera) {
  const double first_s = camera.configure({0.01, 100, 8.0}).exposure_s;
  const Picture first = camera.capture(), again = camera.capture();
  const double second_s = camera.configure({2 * first_s, 100, 8.0}).exposure_s;
  const Picture longer = camera.capture();
  const bool differ = first.bytes != again.bytes && again.bytes != longer.bytes;
  const bool in_order = first.utc < again.utc && again.utc < longer.utc;  // ISO 8601 sorts as text
  return {differ && in_order && second_s > first_s && same_time(longer.settings.exposure_s, second_s),
          words(differ ? "all differ" : "the same bytes came twice", ", begun ", first.utc, ", ", again.utc, ", ",
                longer.utc)};
}

// The live view must be a whole JPEG, which begins and ends with its markers.
Verdict live_view(Camera& camera) {
  const std::vector<std::byte> jpeg = camera.preview();
  const auto is = [&](std::size_t at, int value) { return std::to_integer<int>(jpeg.at(at)) == value; };
  const bool whole =
      jpeg.size() > 4 && is(0, 0xff) && is(1, 0xd8) && is(jpeg.size() - 2, 0xff) && is(jpeg.size() - 1, 0xd9);
  return {whole, words(jpeg.size(), " bytes", whole ? " of a JPEG" : " that are no JPEG")};
}

}  // namespace

std::vector<ContractRow> check_turntable(Turntable& turntable, double tolerance_rad, bool has_motor) {
  return {
      row("homing makes the angle 0", [&] { return homing(turntable, tolerance_rad); }),
      row("a stop ends a move and keeps the position", [&] { return stopping(turntable, tolerance_rad, has_motor); }),
      row("moves are reached and read back", [&] { return moves(turntable, tolerance_rad); }),
      row("returning to 0 reads the same", [&] { return return_to_zero(turntable, tolerance_rad); }),
      row("an angle out of range is refused", [&] { return refuses(turntable, 1e6); }),
      row("an angle that is not a number is refused", [&] { return refuses(turntable, kNan); }),
      row("an infinite angle is refused", [&] { return refuses(turntable, -kInfinity); }),
      row("homing works again", [&] { return homing(turntable, tolerance_rad); }),
  };
}

std::vector<ContractRow> check_camera(Camera& camera) {
  return {
      row("the camera says which one it is", [&] { return identity(camera); }),
      row("shutter times are offered in ascending order", [&] { return shutter_times(camera); }),
      row("settings are read back as asked", [&] { return settings_read_back(camera); }),
      row("a shutter time that is not offered becomes one that is", [&] { return offered_time(camera); }),
      row("an exposure that is not a number is refused", [&] { return refuses_exposure(camera, kNan); }),
      row("a negative exposure is refused", [&] { return refuses_exposure(camera, -1.0); }),
      row("a picture has bytes, a date and the settings asked", [&] { return picture_as_configured(camera); }),
      row("the live view shows a picture", [&] { return live_view(camera); }),
      row("each picture is a new one", [&] { return fresh_pictures(camera); }),
  };
}

bool all_passed(const std::vector<ContractRow>& rows) {
  return std::ranges::all_of(rows, [](const ContractRow& one) { return one.passed; });
}

}  // namespace rig
