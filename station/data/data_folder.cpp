#include "station/data/data_folder.h"

#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>

namespace station {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "THREADSTATION_DATA";
constexpr const char* kProof = "rigs";  // a folder that no other program's data has by chance

bool is_data(const fs::path& folder) {
  std::error_code code;
  return fs::is_directory(folder / kProof, code);
}

std::optional<fs::path> named_folder() {
  const char* named = std::getenv(kVariable);
  if (!named || !*named) return std::nullopt;
  return fs::path(named);
}

std::optional<fs::path> folder_of_program() {
  std::error_code code;
  const fs::path program = fs::read_symlink("/proc/self/exe", code);
  for (fs::path above = program.parent_path(); above.has_relative_path(); above = above.parent_path())
    if (is_data(above / THREADSTATION_DATADIR)) return above / THREADSTATION_DATADIR;
  return std::nullopt;
}

}  // namespace

fs::path data_folder() {
  if (const auto named = named_folder()) {
    if (!is_data(*named))
      throw std::runtime_error(std::string(kVariable) + " names " + named->string() + ", which has no folder " +
                               kProof + "; name the folder share/threadstation of an installation, or leave it out");
    return *named;
  }
  if (const auto found = folder_of_program()) return *found;
  throw std::runtime_error(std::string("the data that come with the program (" THREADSTATION_DATADIR
                                       ") are not beside it; install it again, or name their folder by ") +
                           kVariable);
}

fs::path data_folder_name() {
  if (const auto named = named_folder()) return *named;
  return folder_of_program().value_or(fs::path("/usr") / THREADSTATION_DATADIR);
}

}  // namespace station
