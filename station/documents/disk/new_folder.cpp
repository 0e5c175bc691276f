#include "station/documents/disk/new_folder.h"

#include <stdexcept>

#include "station/documents/disk/stored_file.h"

namespace station {

void make_new_folder(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code code;
  if (fs::exists(folder, code) && (!fs::is_directory(folder, code) || !fs::is_empty(folder, code)))
    throw std::runtime_error("'" + folder.string() + "' is there and not an empty folder; choose another --out");
  make_folder(folder);
}

}  // namespace station
