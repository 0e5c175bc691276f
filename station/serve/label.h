// A label to print for a spool: what it is in words, and a QR code that a scanner types into the page.
#pragma once

#include <string>

#include "station/thread/library.h"

namespace station {

// An SVG drawing of 62 x 29 mm, a common size of label printers. The code holds the spool's barcode, or
// "thread-<number>" where it has none. Errors: std::runtime_error for a barcode that no QR code can hold.
std::string label_svg(const LibraryThread& thread);

}  // namespace station
