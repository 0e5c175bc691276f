// The measures of a patch: crimp, thickness, cover and the gap between its yarns, all taken from the splines
// themselves.
#pragma once

#include "renderer/weave/patch.h"

namespace renderer {

// Fills the measured members of the patch.
void measure(YarnPatch& patch);

// The length of one period of a yarn divided by the length of cloth that it spans, minus 1.
double crimp(const YarnPatch& patch, const Yarn& yarn);

// The heights between which all surfaces lie, mm, sampled finely enough to be exact to 1e-4 of a radius for smooth
// yarns.
struct SurfaceRange {
  double low_mm = 0.0, high_mm = 0.0;
};
SurfaceRange surface_range(const YarnPatch& patch);

// The conventional cover factor from radii and periods, with yarns taken as straight in plan and each system as at most
// 1.
double cover(const YarnPatch& patch);

// The mass of the yarns over the area of the cell, g / m^2; 0 where a yarn's tex is unknown.
double areal_mass(const YarnPatch& patch);

// The least distance between the surfaces of two different yarns, periodic images included; negative where they
// overlap. It is sampled four times per spline segment, then refined at the closest pair. It is the distance of the
// centre lines minus both radii, so that two yarns that have passed through each other must be found by their order,
// not by this gap.
double least_gap(const YarnPatch& patch);

}  // namespace renderer
