// Long work of the renderer before there is anything to render: it shows how far it is, and ctrl-C ends it.
//
// Each shows nothing in its first second. Ctrl-C counts from watch_interrupts() on (interrupt.h). Errors: those of the
// work; std::runtime_error, one line, when ctrl-C came.
#pragma once

#include "renderer/scene/garment.h"
#include "renderer/weave/woven_patch.h"
#include "station/output/progress.h"

namespace station {

renderer::RelaxedPatch weave_watched(const renderer::Draft& draft, ProgressDisplay& progress);
renderer::UvMesh garment_watched(const renderer::GarmentShape& shape, ProgressDisplay& progress);

}  // namespace station
