// The cloths that the tests of the relaxation have in common.
#pragma once

#include <vector>

#include "renderer/weave/relaxation.h"

namespace renderer {

// A plain cloth of yarns of 0.5 mm: D, the sum of both diameters, is 1 mm, so that pitches are p / D.
Draft plain_cloth(double warp_pitch_mm, double weft_pitch_mm, double tension_n);

// A twill and a satin whose systems differ.
std::vector<Draft> uneven_drafts();

// The ready weaves at the setts of station/data/drafts, with `yarns` yarns or a little more each way.
std::vector<Draft> ready_weaves(std::size_t yarns);

// The cloth turned by 90 degrees about z: weft becomes warp; what is on top stays on top.
Draft turned(const Draft& draft);

// Relaxes a draft of yarns of 0.5 mm, prints what it took, and expects it at rest, not jammed, with little overlap.
void expect_woven(const Draft& draft);

// Expects that the patch came to rest at a gradient below 1e-6 of the pull on the yarns, as drafted.
void expect_at_rest(const RelaxedPatch& relaxed);

}  // namespace renderer
