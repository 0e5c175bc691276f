// Pictures for the technician's page, as PNG or SVG files that a browser shows: small ones of raw files, photographs
// beside their fitted twins, cloth, drafts.
#pragma once

#include <string>

#include "station/serve/http_message.h"
#include "station/serve/last_frame.h"
#include "station/serve/workspace.h"

namespace station {

// The picture that a request to /picture asks for, by its "of":
//   raw           session, step: the picture that the journal has of it, as small as a tile; size=large: as large as a
//                 screen shows
//   photographed, fitted, residual   session, view: cut to the threads
//   cloth         session, view: "swatch" or "cylinder"
//   design        name, view: the same of a design
//   draft         name: of a ready draft, as weavers draw it
//   thread        number: a thread of the library as its cloth, or else on its spool
//   frame         the last one of the live view
// In the four lines in the middle a white card is white, and "stops" (-8 to 8) make all of them brighter alike.
// Throws Refused: 400 for a name that is none, 404 for what is not there.
HttpResponse page_picture(const HttpRequest& request, const Workspace& workspace, const LastFrame& frame);

}  // namespace station
