// Where the files lie that come with the program: the folders of station/data (README.md there), wherever the program
// was installed or built.
#pragma once

#include <filesystem>

namespace station {

// The folder that the environment variable THREADSTATION_DATA names; without it the nearest share/threadstation beside
// the running program or above it: /usr/share/threadstation for /usr/bin/threadstation, that of the build folder for
// what was built there. Throws std::runtime_error, one line, when it is not there.
std::filesystem::path data_folder();

// The same for texts that only name the folder: where an installation has it when it is not found.
std::filesystem::path data_folder_name();

}  // namespace station
