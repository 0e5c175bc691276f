// A loop over the pixels of a picture, tile by tile on all cores.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <opencv2/core.hpp>
#include <thread>
#include <vector>

#include "renderer/picture/pixel_rays.h"

namespace renderer {

// Calls work(rays, column, row) once for each pixel of the given parts of the picture, the parts in parallel on
// `threads` cores (0: all). go_on() is asked now and then, from the calling thread alone. Returns false when go_on()
// said no; some rows of pixels are then left out.
template <class Work, class GoOn>
bool for_each_pixel(const Camera& camera, const std::vector<cv::Rect>& parts, int threads, const Work& work,
                    const GoOn& go_on) {
  std::atomic<bool> stopped{false};
  const std::thread::id caller = std::this_thread::get_id();
  const auto draw = [&](std::size_t number) {
    const cv::Rect& part = parts[number];
    if (stopped) return;
    const PixelRays rays(camera, part.x, part.y, part.width, part.height);
    for (int row = part.y; row < part.y + part.height && !stopped; ++row) {
      for (int column = part.x; column < part.x + part.width; ++column) work(rays, column, row);
      if (std::this_thread::get_id() == caller && !go_on()) stopped = true;
    }
  };
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(threads > 0 ? std::min(threads, cores) : cores);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, parts.size(), draw, tbb::simple_partitioner()); });
  return !stopped;
}

}  // namespace renderer
