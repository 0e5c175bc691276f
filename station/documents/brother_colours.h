// Brother's chart of 64 embroidery threads, by the numbers that PES files name them with.
// Values: edutechwiki.unige.ch/en/Embroidery_format_PEC (colour table)
#pragma once

#include "renderer/embroidery/motif.h"

namespace station {

// A number outside of 1 ... 64 is a thread of unknown colour.
renderer::MotifThread brother_thread(int number);

}  // namespace station
