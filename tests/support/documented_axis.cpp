#include "tests/support/documented_axis.h"

#include <algorithm>
#include <cmath>

namespace {
constexpr double kNear = 1e-6;   // steps
constexpr double kSlow = 1e-7;   // steps per second
constexpr double kSoon = 1e-12;  // seconds
}  // namespace

void DocumentedAxis::halt() {
  moves_.clear();
  speed_ = 0;
  at_ = std::round(at_);
  holding_ = false;
}

void DocumentedAxis::count_from(double steps) {
  halt();
  at_ = steps;
}

void DocumentedAxis::advance(double seconds) {
  while (seconds > kSoon && turning()) seconds -= holding_ ? slow_down(seconds) : follow(seconds);
}

// The speed with which the first move may end, so that the last one can still come to rest: the laws of a planner that
// looks ahead. A turn back needs a stand.
double DocumentedAxis::leaving_speed() const {
  double leaving = moves_.back().abrupt ? moves_.back().speed : 0;
  for (std::size_t next = moves_.size() - 1; next > 0; --next) {
    const double begin = moves_[next - 1].target, before = next > 1 ? moves_[next - 2].target : at_;
    const double way = moves_[next].target - begin;
    const bool onwards = way * (begin - before) > 0;
    const double entering = std::sqrt(leaving * leaving + 2 * moves_[next].acceleration * std::abs(way));
    leaving = onwards ? std::min({moves_[next - 1].speed, moves_[next].speed, entering}) : 0;
  }
  return leaving;
}

// One piece of time with a steady change of speed; returns its length.
double DocumentedAxis::go(double seconds, double change) {
  at_ += direction_ * (speed_ * seconds + change * seconds * seconds / 2);
  speed_ = std::max(0.0, speed_ + change * seconds);
  return seconds;
}

double DocumentedAxis::slow_down(double seconds) {
  const double piece = go(std::min(seconds, speed_ / acceleration_), -acceleration_);
  forget_passed_moves();
  if (speed_ <= kSlow) {
    speed_ = 0;
    at_ = std::round(at_);
  }
  return piece;
}

// A hold may end beyond the end of a move, in one that goes on the same way; one that goes back is not begun yet.
void DocumentedAxis::forget_passed_moves() {
  while (!moves_.empty() && (moves_.front().target - at_) * direction_ <= kNear) {
    const double passed = moves_.front().target;
    moves_.pop_front();
    if (!moves_.empty() && (moves_.front().target - passed) * direction_ <= 0) return;
  }
}

double DocumentedAxis::follow(double seconds) {
  const Move move = moves_.front();
  const double way = std::abs(move.target - at_);
  if (way <= kNear) {
    arrive();
    return 0;
  }
  direction_ = move.target > at_ ? 1 : -1;
  acceleration_ = move.acceleration;
  const double leaving = std::min(leaving_speed(), std::sqrt(speed_ * speed_ + 2 * acceleration_ * way));
  const double braking = (speed_ * speed_ - leaving * leaving) / (2 * acceleration_);
  if (way <= braking + kNear) {
    const double left = (speed_ - leaving) / acceleration_;
    const double piece = go(std::min(seconds, left), -acceleration_);
    if (piece >= left) arrive();
    return piece;
  }
  if (speed_ < move.speed - kSlow) {
    const double peak = std::sqrt(acceleration_ * way + (speed_ * speed_ + leaving * leaving) / 2);
    const double until = (std::min(move.speed, peak) - speed_) / acceleration_;
    return go(std::min(seconds, std::max(until, kSoon)), acceleration_);
  }
  return go(std::min(seconds, std::max((way - braking) / speed_, kSoon)), 0);
}

// At the end of the first move: on into the next one, or at rest.
void DocumentedAxis::arrive() {
  const Move done = moves_.front();
  moves_.pop_front();
  at_ = done.target;
  const bool onwards = !moves_.empty() && (moves_.front().target - at_) * direction_ > 0;
  if (done.abrupt || !onwards) speed_ = 0;
}
