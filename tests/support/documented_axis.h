// The motor of the documented GRBL (documented_grbl.h): moves with trapezoids of speed, one after the other, in steps.
#pragma once

#include <cstddef>
#include <deque>

class DocumentedAxis {
 public:
  struct Move {
    double target = 0;                   // steps
    double speed = 0, acceleration = 0;  // steps per second, and per second squared
    bool abrupt = false;                 // ends at full speed: a switch, which ends the move, stands there
  };

  void add(const Move& move) { moves_.push_back(move); }
  std::size_t planned() const { return moves_.size(); }
  double end() const { return moves_.empty() ? at_ : moves_.back().target; }  // where all moves end

  void hold() { holding_ = true; }  // slows down as the acceleration allows
  void resume() { holding_ = false; }
  void drop() { moves_.clear(); }
  void halt();                    // stands still at once and forgets its moves
  void count_from(double steps);  // only while it stands

  void advance(double seconds);
  bool turning() const { return speed_ > 0 || (!holding_ && !moves_.empty()); }
  double steps() const { return at_; }
  double speed() const { return speed_; }  // never negative
  double direction() const { return direction_; }
  double braking_steps() const { return acceleration_ > 0 ? speed_ * speed_ / (2 * acceleration_) : 0; }

 private:
  double leaving_speed() const;
  double slow_down(double seconds);
  double follow(double seconds);
  double go(double seconds, double change);
  void arrive();
  void forget_passed_moves();

  std::deque<Move> moves_;
  double at_ = 0, speed_ = 0, direction_ = 1, acceleration_ = 0;
  bool holding_ = false;
};
