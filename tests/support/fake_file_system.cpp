#include "tests/support/fake_file_system.h"

#include <sys/stat.h>

#include <csignal>
#include <system_error>

namespace station {
namespace fs = std::filesystem;

bool FakeFileSystem::in_trouble() {
  ++calls;
  return (trouble == Trouble::fail_from_then_on && calls >= at_call) || (trouble != Trouble::none && calls == at_call);
}

void FakeFileSystem::suffer() const {
  if (trouble == Trouble::kill) ::raise(SIGKILL);
  throw std::system_error(error, std::generic_category());
}

OpenFile FakeFileSystem::open(const fs::path& path, int flags) {
  if (in_trouble()) suffer();
  OpenFile file = FileSystem::open(path, flags);
  unsynced_.erase(file.descriptor());  // of a file that is closed
  return file;
}

void FakeFileSystem::write(const OpenFile& file, std::span<const std::byte> bytes) {
  const bool trouble_now = in_trouble();
  const auto written = trouble_now ? bytes.first(bytes.size() / 2) : bytes;
  if (volatile_cache) {
    auto& waiting = unsynced_[file.descriptor()];
    waiting.insert(waiting.end(), written.begin(), written.end());
  } else {
    FileSystem::write(file, written);
  }
  if (trouble_now) suffer();
}

void FakeFileSystem::sync(const OpenFile& file) {
  if (in_trouble()) suffer();
  FileSystem::write(file, unsynced_[file.descriptor()]);
  unsynced_.erase(file.descriptor());
  struct stat status {};
  if (::fstat(file.descriptor(), &status) == 0 && S_ISDIR(status.st_mode)) {
    for (const auto& [from, to] : unsynced_names_) FileSystem::rename(from, to);
    unsynced_names_.clear();
  }
}

void FakeFileSystem::rename(const fs::path& from, const fs::path& to) {
  if (in_trouble()) suffer();
  if (volatile_cache)
    unsynced_names_.emplace_back(from, to);
  else
    FileSystem::rename(from, to);
}

}  // namespace station
