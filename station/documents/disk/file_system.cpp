#include "station/documents/disk/file_system.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

namespace station {
namespace {

[[noreturn]] void throw_errno(const char* call) {
  throw std::system_error(errno, std::generic_category(), call);
}

}  // namespace

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) ::close(descriptor_);  // what matters has been synced before; there is nobody to tell here
}

OpenFile::OpenFile(OpenFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

OpenFile FileSystem::open(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor < 0) throw_errno("open");
  return OpenFile(descriptor);
}

void FileSystem::write(const OpenFile& file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.descriptor(), bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) throw_errno("write");
    if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void FileSystem::sync(const OpenFile& file) {
  if (::fsync(file.descriptor()) != 0) throw_errno("fsync");
}

void FileSystem::rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) throw_errno("rename");
}

void FileSystem::sync_folder(const std::filesystem::path& folder) {
  sync(open(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY));
}

}  // namespace station
