#include "rig/people/manual_turntable.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "rig/devices/degree.h"
#include "rig/devices/tracked_turntable.h"

namespace rig {
namespace {
constexpr double kReadToDeg = 0.5;  // what a scale on a platform is read to
constexpr int kMostTries = 3;

// Blanks around it are allowed, and a comma for a point, as it is typed in half of Europe.
std::optional<double> typed_degrees(std::string text) {
  const std::size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  text = begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
  if (const std::size_t comma = text.find(','); comma != std::string::npos) text[comma] = '.';
  double value = 0;
  const auto [last, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = !text.empty() && error == std::errc{} && last == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// Nothing but a hand moves it; who waits for the hand learns of a stop with the next answer.
class ManualTurntable final : public TrackedTurntable {
 public:
  explicit ManualTurntable(AskedPerson& asked) : asked_(asked) {}

  void home() override {
    turn_to(0, "Turn the platform until its mark is in front (0 deg).", TurntableState::unknown_position);
  }

  void move_to(double angle_rad) override {
    require_reachable(angle_rad);
    turn_to(angle_rad,
            "Turn the platform to " + degrees_text(angle_rad) + " (counter-clockwise seen from above is more).",
            state());
  }

 private:
  void turn_to(double angle_rad, const std::string& todo, TurntableState otherwise) {
    begin_moving();
    try {
      came_to(confirmed(angle_rad, todo));
    } catch (...) {
      end_moving(otherwise);
      throw;
    }
    end_moving(stop_asked() ? TurntableState::stopped : TurntableState::idle);
    if (stop_asked()) {
      throw std::runtime_error("the session was stopped while the platform was turned to " + degrees_text(angle_rad) +
                               "; ask for the move again when it is safe");
    }
  }

  double confirmed(double angle_rad, const std::string& todo) {
    Question question{.text = todo,
                      .how = "Press Enter when it stands there, or type the angle that you read; q and Enter to end: ",
                      .typed = "the angle that you read, in degrees",
                      .turn_to_deg = angle_rad / kDegree};
    question.choices.front().label = "It stands there";
    for (int tries = 0; tries < kMostTries; ++tries) {
      const std::string answer = ask_or_end(asked_, question);
      if (answer == kDone) return angle_rad;
      const auto read_deg = typed_degrees(answer);
      if (read_deg && std::abs(*read_deg - angle_rad / kDegree) <= kReadToDeg) return *read_deg * kDegree;
      question.remark =
          read_deg ? "That is not " + degrees_text(angle_rad) + "; turn it on." : "That is no angle in degrees.";
    }
    throw std::runtime_error("the platform was to be turned to " + degrees_text(angle_rad) +
                             " by hand and no such angle was read three times; see that it turns freely, then resume");
  }

  AskedPerson& asked_;
};

}  // namespace

std::unique_ptr<Turntable> make_manual_turntable(AskedPerson& asked) {
  return std::make_unique<ManualTurntable>(asked);
}

}  // namespace rig
