#include "renderer/embroidery/motif.h"

namespace renderer {

MotifMeasures measure(const Motif& motif) {
  MotifMeasures found;
  found.stitches_of_threads.assign(motif.threads.size(), 0);
  found.lengths_mm.assign(motif.threads.size(), 0);
  bool first = true;
  for (const StitchRun& run : motif.runs) {
    const auto thread = static_cast<std::size_t>(run.thread);
    for (std::size_t i = 0; i < run.needle_points.size(); ++i) {
      const Eigen::Vector2d& point = run.needle_points[i];
      found.low = first ? point : found.low.cwiseMin(point);
      found.high = first ? point : found.high.cwiseMax(point);
      first = false;
      if (i == 0) continue;
      ++found.stitches, ++found.stitches_of_threads[thread];
      found.lengths_mm[thread] += (point - run.needle_points[i - 1]).norm();
    }
  }
  return found;
}

void MotifRecorder::stitch(const Eigen::Vector2d& move_mm) {
  at_ += move_mm;
  if (cut_) motif_.runs.push_back({.thread = static_cast<int>(motif_.threads.size()) - 1, .needle_points = {}});
  cut_ = false;
  motif_.runs.back().needle_points.push_back(at_);
}

void MotifRecorder::jump(const Eigen::Vector2d& move_mm) {
  at_ += move_mm;
}

void MotifRecorder::trim() {
  cut_ = true;
}

void MotifRecorder::next_thread() {
  cut_ = true;
  motif_.threads.emplace_back();
}

}  // namespace renderer
