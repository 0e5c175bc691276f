// How far a rendering is and how long it still takes, on standard error and not too often.
#pragma once

#include <chrono>

#include "station/output/progress.h"

namespace station {

class RenderProgress {
 public:
  RenderProgress(const std::string& task, ProgressStyle style) : display_(task, style) {}

  // Shows the finished fraction. The time left goes by this run's pace alone: what was there when it began does not
  // count.
  void show(double fraction);
  ProgressDisplay& display() { return display_; }

 private:
  using Clock = std::chrono::steady_clock;
  ProgressDisplay display_;
  Clock::time_point start_{}, shown_{};  // start_: of the first call
  double first_ = -1;                    // fraction that was there already
  int step_ = -1;
};

}  // namespace station
