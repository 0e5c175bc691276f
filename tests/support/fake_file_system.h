// A disk that fails, or ends the process, at a chosen call.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "station/documents/disk/file_system.h"

namespace station {

// A file system that does not wait for the disk: a killed process loses nothing that it has written.
class FakeFileSystem final : public FileSystem {
 public:
  enum class Trouble { none, fail_once, fail_from_then_on, kill };

  Trouble trouble = Trouble::none;
  int at_call = 0;              // number of the call with trouble, from 1
  int error = 0;                // errno of a failure
  bool volatile_cache = false;  // kill loses what was not synced, as a power cut does
  int calls = 0;

  OpenFile open(const std::filesystem::path& path, int flags) override;
  void write(const OpenFile& file, std::span<const std::byte> bytes) override;  // writes half, then has trouble
  void sync(const OpenFile& file) override;
  void rename(const std::filesystem::path& from, const std::filesystem::path& to) override;

 private:
  bool in_trouble();
  void suffer() const;  // throws, or does not return

  std::map<int, std::vector<std::byte>> unsynced_;  // by descriptor
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> unsynced_names_;
};

}  // namespace station
