// Cloth of threads that are as uneven as they were measured to be: shades of each thread, and yarns that differ.
#pragma once

#include <filesystem>
#include <vector>

#include "renderer/weave/draft.h"
#include "station/documents/thread_file.h"

namespace station {

struct ThreadIrregularity {
  double shade = 0, diameter = 0;  // standard deviations of the absorption's logarithm and, as a share, of the diameter
  double length_mm = 0;            // of thread over which it stays alike
};

// As `invert` measured it; what could not be told is 0. Errors: std::runtime_error, one line, for a thread whose
// irregularity was not measured.
ThreadIrregularity irregularity_of(const ThreadFile& thread, const std::filesystem::path& file);

inline constexpr int kThreadShades = 5;

// The thread in shades from light to dark, each as frequent as the others.
std::vector<ThreadFile> shades_of(const ThreadFile& thread, double shade);

// The draft with each of its threads in kThreadShades shades, and with yarns as uneven as the threads of warp and weft
// are on the whole. Its repeat becomes so large that it shows many yarns of each system.
renderer::Draft uneven_draft(renderer::Draft draft, const ThreadIrregularity& warp, const ThreadIrregularity& weft);

}  // namespace station
