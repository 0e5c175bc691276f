// Pictures for the technician's page, as PNG or SVG files that a browser shows: small ones of raw files, photographs
// beside their fitted twins, cloth, drafts.
#pragma once

#include <string>

#include "station/serve/http_message.h"
#include "station/serve/last_frame.h"
#include "station/serve/workspace.h"

namespace station {

// Of a request to /picture, by its "of":
//   raw           session, step: the picture that the journal has of it, as small as a tile
//   photographed, fitted, residual   session, view: cut to the threads, brightness alike for the three
//   cloth         session, view: "swatch" or "cylinder"
//   draft         name: of a ready one, as weavers draw it
//   frame         the last one of the camera
// Throws Refused: 400 for a name that is none, 404 for what is not there.
HttpResponse page_picture(const HttpRequest& request, const Workspace& workspace, const LastFrame& frame);

}  // namespace station
