#include "station/cloth/render/render_progress.h"

namespace station {

void RenderProgress::show(double fraction) {
  constexpr int kSteps = 20;
  constexpr std::chrono::seconds kLeastEvery{30};
  const Clock::time_point now = Clock::now();
  if (first_ < 0) first_ = fraction, start_ = now;
  const int step = static_cast<int>(kSteps * fraction);
  if (step == step_ && now - shown_ < kLeastEvery) return;
  const double gained = fraction - first_, elapsed_s = std::chrono::duration<double>(now - start_).count();
  display_.show(static_cast<int>(100 * fraction), 100, "%", gained > 0 ? elapsed_s / gained * (1 - fraction) : -1);
  step_ = step;
  shown_ = now;
}

}  // namespace station
