#include "station/documents/disk/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <iomanip>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "station/documents/disk/stored_file.h"

namespace station {
namespace {

constexpr int kWidth = 20;  // of any process number

}  // namespace

bool folder_in_use(const std::filesystem::path& folder) {
  const OpenFile file(::open((folder / kLockFile).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  return file.descriptor() >= 0 && ::flock(file.descriptor(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

std::optional<OpenFile> try_lock_folder(const std::filesystem::path& folder, FileSystem& file_system) {
  const std::filesystem::path path = folder / kLockFile;
  try {
    OpenFile file = file_system.open(path, O_RDWR | O_CREAT);
    if (::flock(file.descriptor(), LOCK_EX | LOCK_NB) != 0) {
      if (errno != EWOULDBLOCK) throw std::system_error(errno, std::generic_category());
      return std::nullopt;
    }
    // The number always has the same length, so that it replaces the one before without a moment in which the file is
    // empty.
    std::ostringstream process;
    process << std::setw(kWidth) << ::getpid() << '\n';
    const std::string text = process.str();
    file_system.write(file, std::as_bytes(std::span(text)));
    return file;
  } catch (const std::system_error& error) {
    throw std::runtime_error(write_problem(path, error.code()));
  }
}

OpenFile lock_folder(const std::filesystem::path& folder, FileSystem& file_system) {
  if (std::optional<OpenFile> file = try_lock_folder(folder, file_system)) return std::move(*file);
  const int holder = holder_of_lock(folder);
  throw std::runtime_error("the session '" + folder.string() + "' is in use by " +
                           (holder > 0 ? "process " + std::to_string(holder) : "another process") +
                           "; wait until it ends, or end it");
}

int holder_of_lock(const std::filesystem::path& folder) {
  int process = 0;
  std::ifstream(folder / kLockFile) >> process;
  return process;
}

}  // namespace station
