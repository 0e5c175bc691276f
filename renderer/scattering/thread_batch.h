// Evaluation of one thread model at many places at once: values and densities for arrays of offsets and directions, in
// packets of floats. The results equal those of thread.h within single precision. On any x86-64 processor about three
// times as many places per second are evaluated as one by one; a build for x86-64-v3 has packets of 8 instead of 4.
#pragma once

#include <array>
#include <span>

#include "renderer/scattering/thread.h"

namespace renderer {

// Arrays of places, component by component; all spans of one call have the same length.
struct ThreadPlaces {
  std::span<const float> h;                      // offsets, -1 .. 1
  std::array<std::span<const float>, 3> wo, wi;  // x, y, z of unit directions (lobes.h)
};
struct ThreadValues {
  std::array<std::span<float>, 3> f_cos;  // RGB, includes the cosine
  std::span<float> pdf;                   // density of sampling wi, per solid angle
};

// Fills `values` with the model's values at `places`.
void evaluate_batch(const ThreadModel<float>& model, const ThreadPlaces& places, const ThreadValues& values);

}  // namespace renderer
