// A folder of exports/ as one file for a browser: an export is of no use in a folder of the computer at the bench when
// who asked sits elsewhere.
#pragma once

#include <filesystem>

#include "station/serve/http_message.h"

namespace station {

// The folder's files in a ZIP archive that unpacks into a folder of the same name. Throws Refused: 404 without the
// folder, 413 for more than 512 MiB.
HttpResponse zip_of(const std::filesystem::path& folder);

}  // namespace station
