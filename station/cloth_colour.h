// The thread of which a cloth has a wanted colour: all of a digitized thread is kept but its absorption [Xia 2025, section 6].
//
// The cloth lies in light that is the same from all sides, with as much of it behind; its reflectance (with what passes
// through) is measured once over absorption and inverted channel by channel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>

#include "inversion/absorption_curve.h"
#include "renderer/weave/patch.h"
#include "station/documents/thread_file.h"
#include "station/embroider/embroider_motif.h"

namespace station {

// Of the cloth, all of it of this thread, in light of 1 from all sides: camera RGB, noise about 0.01.
Eigen::Array3d even_light_reflectance(const renderer::YarnPatch& patch, const renderer::ThreadParameters& thread,
                                      std::uint64_t seed = 1);

struct ColouredThread {
  renderer::ThreadParameters parameters;
  double delta_e_2000 = 0;  // of what it should look like from the wanted colour: above 0 out of gamut
};

// The thread with the absorption that has the colour by these curves, all else kept.
ColouredThread coloured_thread(const ThreadFile& thread, const std::array<inversion::AbsorptionCurve, 3>& curves,
                               const Srgb8& colour);

class ClothColours {
 public:
  // `done` is told the finished part. Errors: std::runtime_error when ctrl-C stops it.
  ClothColours(const ThreadFile& thread, const renderer::YarnPatch& patch, const std::function<void(double)>& done);

  ColouredThread thread_of(const Srgb8& colour) const;

 private:
  ThreadFile thread_;
  std::array<inversion::AbsorptionCurve, 3> curves_;
};

}  // namespace station
