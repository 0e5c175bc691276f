// Views of a wrapped spool whose thread is known, for the tests of the fit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "inversion/view/view.h"
#include "renderer/scattering/thread.h"

namespace inversion {

// A thread with every lobe at work, far from any fit's start; its energies sum to less than 0.94 at every angle.
renderer::ThreadParameters known_thread();

// A thread that keeps nearly all light: energies sum to between 0.89 and 0.97, almost nothing is absorbed.
renderer::ThreadParameters white_thread();

// The three lobe energies at c = cos theta, without the limit on their sum.
std::array<double, 3> energies_at(renderer::ThreadParameters parameters, double c);

// The place of camera and lamp: directions from the holder's middle, in degrees. Azimuth turns in the plane of the
// thread's axis and the front's normal, elevation leaves it.
struct Standpoint {
  const char* id;
  double camera_azimuth_deg, camera_elevation_deg;
  double lamp_azimuth_deg, lamp_elevation_deg;
  bool threads_upright = false;
};

// A view without a picture, its mask that of the threads. It is 3:2 and shows the whole sheet.
View unlit_view(const WrappedSpool& spool, const Standpoint& standpoint, int width_px);

// Six standpoints: reflections with lying and with upright threads, and transmissions.
std::vector<Standpoint> six_standpoints();

// The view with a photograph of the thread, which has no noise but that of the path tracer.
View photographed(View view, const WrappedSpool& spool, const renderer::ScatteringModel& thread, int samples_per_pixel,
                  std::uint64_t seed);

// Views from all six standpoints, photographed with independent noise.
std::vector<View> photographs(const WrappedSpool& spool, const renderer::ScatteringModel& thread, int width_px,
                              int samples_per_pixel);

}  // namespace inversion
