// The handbook's pages and drawings (station/handbook), for the browser.
#pragma once

#include <string>

#include "station/serve/http_message.h"

namespace station {

inline constexpr const char* kHandbook = "/handbook/";

// The file of the handbook that a path below /handbook/ names. Throws Refused (404) for anything else.
HttpResponse handbook_page(const std::string& path);

}  // namespace station
