// The single fiber whose scattering is nearest to a thread's, for renderers that know fibers only, and how near it is.
//
// A thread has widths and energies of its own for each lobe, a fiber one refractive index, one absorption per channel
// and two roughnesses for all of them: few threads have an equal. The nearest fiber is found by least squares over eta,
// sigma_a, beta_m and beta_n (tilt 0: textile fibers have no scales) of three relative errors, the root mean squares of
//
//   f_cos   over all offsets h, all directions i by solid angle and all directions o
//   albedo  over all directions o and channels (f_cos over h and the sphere of i; lobes' energies, without sampling)
//   back    over the same: the light that goes to the viewer's side, phi within 90 deg
//
// of which the second and third count ten times as much, so that colour and brightness come first: light is scattered
// many times between threads, and squares of f_cos alone are those of its narrow peaks. The refractive indices found
// say nothing about the thread's substance; the search ends at 1.01 and 3.
//
// Directions o are those from which a thread is seen when it lies in all directions alike: by solid angle times the
// width that it shows, cos theta_o. Where light leaves a thread (ThreadExit) is no part of f_cos: fibers send it on
// from where it came in.
#pragma once

#include <Eigen/Core>

#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread.h"

namespace inversion {

// Relative errors: root mean square of the difference over that of the thread.
struct FiberAgreement {
  double rms = 0;      // of f_cos, each h by itself
  double rms_far = 0;  // of f_cos averaged over h: seen from afar
  // Means over h and o: of all light, and of what goes to the viewer's side.
  Eigen::Array3d thread_albedo = Eigen::Array3d::Zero(), fiber_albedo = Eigen::Array3d::Zero();
  Eigen::Array3d thread_back = Eigen::Array3d::Zero(), fiber_back = Eigen::Array3d::Zero();
};

struct NearestFiber {
  renderer::FiberParameters fiber;
  FiberAgreement agreement;  // measured on other and more directions than the fit's
  bool converged = false;
};

inline constexpr double kMostFiberIndex = 3;  // of refraction, at which the search ends

// The fiber nearest to a thread. `colours` (3 x 3) is applied to the thread's f_cos and albedo first; the identity
// leaves the thread's own channels. Errors: std::runtime_error, one line, for a thread that scatters no light.
NearestFiber nearest_fiber(const renderer::ThreadParameters& thread,
                           const Eigen::Matrix3d& colours = Eigen::Matrix3d::Identity());

// How near a fiber is to a thread; `colours` and errors as above.
FiberAgreement fiber_agreement(const renderer::FiberParameters& fiber, const renderer::ThreadParameters& thread,
                               const Eigen::Matrix3d& colours = Eigen::Matrix3d::Identity());

}  // namespace inversion
