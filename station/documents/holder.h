// The holder that a thread is wound on: "holder" of spool files, and of rig files for the spools that the page makes.
#pragma once

#include "inversion/view/wrapped_spool.h"
#include "station/documents/reader.h"

namespace station {

// Reads its five sizes into `wrapping`. Errors: those of reader.h.
void read_holder(ObjectReader holder, inversion::WrappedSpool& wrapping);

}  // namespace station
