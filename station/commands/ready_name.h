// Options that take a file, or the bare name of one that comes with the program: `plain` for the draft
// DATA/drafts/plain.json, `silk_red` for the thread DATA/library/threads/silk_red.json.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace station {

// Makes of a bare name, which is that of no file or folder here, the path of the ready file in that folder of the data
// (data_folder.h). A word with a slash or an ending is a path and stays. A name that there is not is refused with the
// nearest, or with all that there are.
CLI::Option* or_ready(const std::string& folder, CLI::Option* option);

}  // namespace station
