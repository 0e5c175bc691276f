// What is seen of a cloth's fibers close by, for pictures that are looked at: threads scatter as one smooth cylinder
// (thread.h), which a macro photograph shows to be a bundle of fibers that wind round each other, of which some stand
// out. Measurements leave it off, for a fitted thread has its fibers in its lobes already.
#pragma once

#include <cstdint>
#include <optional>

#include "renderer/scene/patch_curves.h"
#include "renderer/scene/scene.h"

namespace renderer {

// The fiber at a place of a yarn's surface: `along_mm` along the yarn, at this azimuth round its axis. Each yarn of the
// endless cloth has fibers of its own, whose numbers repeat nowhere.
FiberAt fiber_at(const FiberDetail& detail, double along_mm, double azimuth_rad, double radius_mm, std::uint64_t yarn);

// Fibers that stand out of the yarns of a patch, as curves in the endless patch's frame: all segments, of whichever
// periodic image, that reach into its cell. Each begins inside its yarn, and winds through the air in a random walk
// that goes on in its direction. `origins` gets an entry for each segment: the yarn that it comes out of.
struct FlyawayCurves {
  CurveSet curves;
  std::vector<SegmentOrigin> origins;
};
FlyawayCurves flyaway_curves(const YarnPatch& patch, const Flyaways& flyaways);

}  // namespace renderer
