// A small bench whose picture is one colour, and a count of how often it was drawn.
#pragma once

#include <memory>

#include "rig/simulated/simulated_bench.h"

struct UniformBench {
  explicit UniformBench(const cv::Vec3f& radiance, rig::BenchTruth truth = {})
      : bench(truth, [this, radiance](const rig::BenchState& state) {
          ++drawings;
          return cv::Mat3f(state.lens.height_px, state.lens.width_px, radiance);
        }) {}

  int drawings = 0;
  rig::SimulatedBench bench;
  rig::SimulatedClock clock{1.8e9};
  std::unique_ptr<rig::Camera> camera = rig::make_simulated_camera(bench, clock);
};
