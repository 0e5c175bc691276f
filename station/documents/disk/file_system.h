// The few calls by which a session reaches the disk, in one place so that a test can let the Nth of them fail.
//
// Errors: std::system_error with the system's code; the callers (stored_file.h) add what was being stored.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace station {

// An open file, closed when it goes out of scope; a descriptor of -1 means no file.
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

// The calls themselves; tests override them.
class FileSystem {
 public:
  FileSystem() = default;
  virtual ~FileSystem() = default;
  FileSystem(const FileSystem&) = delete;
  FileSystem& operator=(const FileSystem&) = delete;

  virtual OpenFile open(const std::filesystem::path& path, int flags);  // flags of open(2); refuses symbolic links
  virtual void write(const OpenFile& file, std::span<const std::byte> bytes);  // writes all bytes
  virtual void sync(const OpenFile& file);  // returns when all that was written is on the disk
  virtual void rename(const std::filesystem::path& from, const std::filesystem::path& to);

  // Makes the names in a folder durable; an empty path is the working folder.
  void sync_folder(const std::filesystem::path& folder);
};

}  // namespace station
