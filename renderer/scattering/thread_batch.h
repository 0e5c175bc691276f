// One thread model at many places at once: values and densities for arrays of offsets and directions, in packets of
// floats. The formula is that of thread.h; agreement with it is that of single precision. About three times as many per
// second as one by one on any x86-64 processor; a build for x86-64-v3 has packets of 8 instead of 4.
#pragma once

#include <array>
#include <span>

#include "renderer/scattering/thread.h"

namespace renderer {

// Component by component; all spans of one call have the same length.
struct ThreadPlaces {
  std::span<const float> h;                      // offsets, -1 .. 1
  std::array<std::span<const float>, 3> wo, wi;  // x, y, z of unit directions (lobes.h)
};
struct ThreadValues {
  std::array<std::span<float>, 3> f_cos;  // RGB, includes the cosine
  std::span<float> pdf;                   // of sampling wi, per solid angle
};

void evaluate_batch(const ThreadModel<float>& model, const ThreadPlaces& places, const ThreadValues& values);

}  // namespace renderer
