// The hashes of a folder of derived files (linear/, masks/, result/), for those who pass a session on: manifest.json,
// {"format": "threadstation/manifest", "version": 1, "files": {name: sha256}}.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "station/documents/disk/file_system.h"

namespace station {

// Writes a manifest that names every regular file of `folder` but the manifest itself; returns how many there are.
std::size_t write_manifest(const std::filesystem::path& folder, FileSystem& file_system);

struct ManifestReport {
  bool present = false;
  std::size_t files = 0;              // number of files that were hashed
  std::vector<std::string> problems;  // one line each
};

// Compares the folder with its manifest: problems are files that differ, are missing, or are not named in it. Without a
// manifest nothing is checked.
ManifestReport check_manifest(const std::filesystem::path& folder);

}  // namespace station
