#include "renderer/picture/picture_bytes.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace renderer {
namespace {

namespace fs = std::filesystem;

// A file that is deleted again unless rename_to() keeps it.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {
    descriptor_ = ::open(path_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!kept_) ::unlink(path_.c_str());
  }

  bool is_open() const { return descriptor_ >= 0; }
  bool write_and_flush(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
      if (n < 0 && errno != EINTR) return false;
      if (n > 0) bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return ::fsync(descriptor_) == 0;
  }
  bool rename_to(const fs::path& target) {
    kept_ = ::rename(path_.c_str(), target.c_str()) == 0;
    return kept_;
  }

 private:
  fs::path path_;
  int descriptor_ = -1;
  bool kept_ = false;
};

void flush_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

void refuse_picture(const std::string& asked, const std::string& found, const std::string& remedy) {
  std::string line = asked + ": " + found + "; " + remedy;
  std::replace(line.begin(), line.end(), '\n', ' ');
  throw std::runtime_error(line);
}

void refuse_damaged_picture(const fs::path& file, const std::string& found) {
  refuse_picture("reading picture " + file.string(), found, "it is damaged, cut short or not a picture: make it again");
}

std::string bytes_of_picture(const fs::path& file) {
  const std::string asked = "reading picture " + file.string();
  std::error_code error;
  if (!fs::is_regular_file(file, error)) refuse_picture(asked, "there is no such file", "check the name");
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) refuse_picture(asked, "it cannot be read", "check who may read it");
  return bytes;
}

void store_picture(const fs::path& file, std::string_view bytes) {
  TemporaryFile temporary(file.string() + "." + std::to_string(::getpid()) + ".partial");
  if (!temporary.is_open() || !temporary.write_and_flush(bytes) || !temporary.rename_to(file))
    refuse_picture("writing picture " + file.string(), std::strerror(errno),
                   "check that the folder exists, is writable and has space");
  flush_folder(file.parent_path());
}

}  // namespace renderer
