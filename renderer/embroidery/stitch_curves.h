// A motif's threads as curves on a flat cloth, z = 0.
//
// Each stitch is a taut thread: it comes out of the cloth at one needle point, goes over whatever has been sewn there
// before, and goes back at the next; its ends lie below the cloth, so that the cloth looks pulled in there. Threads
// give way to neighbours beside them and lie on those that they cross, 0.7 diameters higher, as soft threads do that
// are pressed flat (models of embroidery stack layers by a like share of the thread).
#pragma once

#include <vector>

#include "renderer/embroidery/motif.h"
#include "renderer/scene/scene.h"

namespace renderer {

inline constexpr double kLayerHeight = 0.7;  // of a thread above the one that it crosses, in diameters

struct StitchCurves {
  std::vector<CurveSet> threads;  // one per thread of the motif, maybe empty; the caller sets how they scatter
  double top_mm = 0;              // the highest point of all threads
};

// The curves of a motif's threads. Stitches shorter than a tenth of the diameter are left out: they fasten the thread
// below the cloth. Errors: std::runtime_error, one line, for a diameter that is not above zero, a motif without
// stitches, or one of more than kMostStitches.
inline constexpr int kMostStitches = 1'000'000;
StitchCurves stitch_curves(const Motif& motif, double diameter_mm);

}  // namespace renderer
