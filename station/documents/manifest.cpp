#include "station/documents/manifest.h"

#include <map>
#include <nlohmann/json.hpp>

#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/reader.h"

namespace station {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;
using Hashes = std::map<std::string, std::string>;
constexpr const char* kManifest = "manifest.json";

Hashes hashes_of(const fs::path& folder) {
  Hashes hashes;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && name != kManifest) hashes[name] = sha256_of_file(entry.path());
  }
  return hashes;
}

Hashes read_manifest(const fs::path& file) {
  const json document = read_json_file(file);
  ObjectReader reader(document, file.string(), "manifest");
  const json& files = reader.raw("files");
  reader.finish();
  try {
    return files.get<Hashes>();
  } catch (const json::exception&) {
    reader.refuse("files", "expected an object of names and hashes");
  }
}

}  // namespace

std::size_t write_manifest(const fs::path& folder, FileSystem& file_system) {
  const Hashes hashes = hashes_of(folder);
  const json document = {{"format", "threadstation/manifest"}, {"version", 1}, {"files", hashes}};
  const std::string text = document.dump(2) + "\n";
  store_file(file_system, folder / kManifest, std::as_bytes(std::span(text)));
  return hashes.size();
}

ManifestReport check_manifest(const fs::path& folder) {
  ManifestReport report;
  if (!fs::exists(folder / kManifest)) return report;
  report.present = true;
  const std::string where = folder.filename().string() + "/";
  try {
    const Hashes wanted = read_manifest(folder / kManifest);
    const Hashes found = hashes_of(folder);
    report.files = found.size();
    for (const auto& [name, hash] : wanted)
      if (!found.contains(name))
        report.problems.push_back(where + name + " is missing");
      else if (found.at(name) != hash)
        report.problems.push_back(where + name + " differs from its manifest");
    for (const auto& [name, hash] : found)
      if (!wanted.contains(name)) report.problems.push_back(where + name + " is not named in the manifest");
  } catch (const std::exception& error) {
    report.problems.emplace_back(error.what());
  }
  return report;
}

}  // namespace station
