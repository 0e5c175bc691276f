#include "rig/manual_turntable.h"

#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <istream>
#include <numbers>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>

namespace rig {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLimitRad = 2 * std::numbers::pi * (1 + 1e-9);
constexpr double kReadToDeg = 0.5;  // what a scale on a platform is read to
constexpr int kMostTries = 3;

std::string degrees(double angle_rad) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f deg", angle_rad / kDegree);
  return text.data();
}

// Blanks around it are allowed, and a comma for a point, as it is typed in half of Europe.
std::optional<double> typed_degrees(std::string text) {
  const std::size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  text = begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
  if (const std::size_t comma = text.find(','); comma != std::string::npos) {
    text[comma] = '.';
  }
  double value = 0;
  const auto [last, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = !text.empty() && error == std::errc{} && last == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

class ManualTurntable final : public Turntable {
 public:
  ManualTurntable(std::istream& in, std::ostream& out) : in_(in), out_(out) {}

  void home() override {
    state_ = TurntableState::unknown_position;
    turn_to(0, "Turn the platform until its mark is in front (0 deg).");
  }

  void move_to(double angle_rad) override {
    if (!std::isfinite(angle_rad) || std::abs(angle_rad) > kLimitRad) {
      throw std::runtime_error("the platform was asked to turn to " + degrees(angle_rad) +
                               "; it turns between -360 and 360 deg");
    }
    require_known_position("turn to " + degrees(angle_rad));
    turn_to(angle_rad,
            "Turn the platform to " + degrees(angle_rad) + " (counter-clockwise seen from above is more).");
  }

  // Nothing but a hand moves it; who waits for the hand learns of the stop with the next answer.
  void stop() override {
    stop_asked_ = true;
    auto standing = TurntableState::idle;
    state_.compare_exchange_strong(standing, TurntableState::stopped);
  }

  double angle_rad() override {
    require_known_position("tell its angle");
    return reading_rad_;
  }

  TurntableState state() override { return state_; }

 private:
  void require_known_position(const std::string& asked) const {
    if (state_ == TurntableState::unknown_position) {
      throw std::runtime_error("the platform was asked to " + asked + ", but its position is unknown; home it first");
    }
  }

  void turn_to(double angle_rad, const std::string& todo) {
    stop_asked_ = false;
    const TurntableState before = state_;
    state_ = TurntableState::moving;
    try {
      reading_rad_ = confirmed(angle_rad, todo);
    } catch (...) {
      state_ = before;
      throw;
    }
    state_ = stop_asked_ ? TurntableState::stopped : TurntableState::idle;
    if (stop_asked_) {
      throw std::runtime_error("the session was stopped while the platform was turned to " + degrees(angle_rad) +
                               "; ask for the move again when it is safe");
    }
  }

  double confirmed(double angle_rad, const std::string& todo) {
    for (int tries = 0; tries < kMostTries; ++tries) {
      out_ << todo << "\nPress Enter when it stands there, or type the angle that you read; q and Enter to end: "
           << std::flush;
      std::string answer;
      if (!std::getline(in_, answer)) {
        throw std::runtime_error("asked to: \"" + todo +
                                 "\", but the input ended before anybody answered; run it at a terminal");
      }
      if (answer == "q" || answer == "Q") {
        throw std::runtime_error("asked to: \"" + todo + "\", and the person declined; resume when it can be done");
      }
      if (answer.find_first_not_of(" \t\r") == std::string::npos) {
        return angle_rad;
      }
      const auto read_deg = typed_degrees(answer);
      if (read_deg && std::abs(*read_deg - angle_rad / kDegree) <= kReadToDeg) {
        return *read_deg * kDegree;
      }
      out_ << (read_deg ? "That is not " + degrees(angle_rad) + "; turn it on." : "That is no angle in degrees.")
           << "\n";
    }
    throw std::runtime_error(
        "the platform was to be turned to " + degrees(angle_rad) +
        " by hand and no such angle was read three times; see that it turns freely, then resume");
  }

  std::istream& in_;
  std::ostream& out_;
  double reading_rad_ = 0;
  std::atomic<TurntableState> state_ = TurntableState::unknown_position;
  std::atomic<bool> stop_asked_ = false;
};

}  // namespace

std::unique_ptr<Turntable> make_manual_turntable(std::istream& in, std::ostream& out) {
  return std::make_unique<ManualTurntable>(in, out);
}

}  // namespace rig
