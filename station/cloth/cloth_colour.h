// The thread that gives a cloth a wanted colour: a digitized thread of which only the absorption is changed [Xia 2025,
// section 6].
//
// The cloth lies in light that is the same from all sides, front and back. Its reflectance, with what passes through,
// is measured once as a function of absorption and inverted channel by channel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>

#include "inversion/texture/absorption_curve.h"
#include "renderer/weave/patch.h"
#include "station/documents/srgb.h"
#include "station/documents/thread_file.h"

namespace station {

// The reflectance, in light of radiance 1 from all sides, of a cloth that consists of this thread: camera RGB, with
// noise of about 0.01.
Eigen::Array3d even_light_reflectance(const renderer::YarnPatch& patch, const renderer::ThreadParameters& thread,
                                      std::uint64_t seed = 1);

using AbsorptionCurves = std::array<inversion::AbsorptionCurve, 3>;  // one for each of the camera's channels

// The curves through the colours (camera RGB) that the thread has at `count` absorptions, alike in all channels.
// `colour_of` measures the thread with one of them. `done` is told the finished part. Errors: std::runtime_error when
// ctrl-C stops it.
AbsorptionCurves absorption_curves(const renderer::ThreadParameters& thread, int count,
                                   const std::function<Eigen::Array3d(const renderer::ThreadParameters&)>& colour_of,
                                   const std::function<void(double)>& done);

struct ColouredThread {
  renderer::ThreadParameters parameters;
  double delta_e_2000 = 0;  // between predicted and wanted colour: above 0 out of gamut
};

// The thread whose absorption gives the colour by these curves; all else is kept.
ColouredThread coloured_thread(const ThreadFile& thread, const AbsorptionCurves& curves, const Srgb8& colour);

// The colours that a cloth of one thread can have; construction measures the curves of absorption.
class ClothColours {
 public:
  // `done` is told the finished part of the measurement. Errors: std::runtime_error when ctrl-C stops it.
  ClothColours(const ThreadFile& thread, const renderer::YarnPatch& patch, const std::function<void(double)>& done);

  ColouredThread thread_of(const Srgb8& colour) const;

 private:
  ThreadFile thread_;
  AbsorptionCurves curves_;
};

}  // namespace station
