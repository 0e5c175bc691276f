// The few calls by which a session reaches the disk, in one place so that a test can let the Nth of them fail.
//
// Errors: std::system_error with the system's code; what was being stored is said by the callers (stored_file.h).
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace station {

// An open file; closed when it goes out of scope. -1: none.
class OpenFile {
 public:
  explicit OpenFile(int descriptor = -1) : descriptor_(descriptor) {}
  ~OpenFile();
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&& other) noexcept;
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

class FileSystem {
 public:
  FileSystem() = default;
  virtual ~FileSystem() = default;
  FileSystem(const FileSystem&) = delete;
  FileSystem& operator=(const FileSystem&) = delete;

  virtual OpenFile open(const std::filesystem::path& path, int flags);  // flags of open(2); symbolic links refused
  virtual void write(const OpenFile& file, std::span<const std::byte> bytes);  // all of them
  virtual void sync(const OpenFile& file);                                     // returns when they are on the disk
  virtual void rename(const std::filesystem::path& from, const std::filesystem::path& to);

  // Makes the names in a folder durable; an empty path is the working folder.
  void sync_folder(const std::filesystem::path& folder);
};

}  // namespace station
